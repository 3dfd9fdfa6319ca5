#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "abbe/geometry/registration/fine_registration.h"
#include "abbe/identify/linkage/scanner_positioning.h"

namespace abbe {

/// A workpiece as a scanner sees it, laid on its part.
struct PlacedWorkpiece {
  bool ok = false;
  std::string status;                 ///< of the registration
  std::vector<std::string> warnings;  ///< of the part
  FineRegistration fine;              ///< part from scan
  Placement placement;                ///< on the table, if ok
};

/// Where a scanner and a workpiece stand, for programs; units in the keys.
/// @param file       name of the scans
/// @param workpiece  null: none was scanned, or the scanner has no position
nlohmann::ordered_json positions_json(const std::string& file, const ScannerPosition& scanner,
                                      const PlacedWorkpiece* workpiece);

/// The same for people, where both have a position; complete lines.
std::string positions_text(const std::string& file, const ScannerPosition& scanner, const PlacedWorkpiece* workpiece);

}  // namespace abbe
