#pragma once

#include <string>

#include "yin/reference.h"

namespace abbe {

/// The five steps in one convention against the reference computed elsewhere.
struct YinSteps {
  LinkageEvaluation found;        ///< from the exact readings, with the accuracies of Table 1 and the microscope
  double largest_difference = 0;  ///< mm, corrected and printed parameters against the reference
};
YinSteps yin_steps(LinkageConvention convention);

/// Positioning from scans.
struct YinPositioning {
  ScannerPosition scanner;
  FineRegistration registration;
  Placement placement;
  PositioningParameters table_to_workpiece, workpiece_to_table;  ///< both readings of Table 3
  double largest_difference = 0;                                 ///< mm (directions: as vectors), from the reference
  std::string failure;                                           ///< why there are no parameters; empty: there are
};
/// The parameters from scanner and registration, or the failure. Needs nothing else.
void place_workpiece(YinPositioning& positioning);

/// From the reference's scans. Standard uncertainties: targets 10 um, sphere and workpiece 20 um.
YinPositioning yin_positioning();

}  // namespace abbe
