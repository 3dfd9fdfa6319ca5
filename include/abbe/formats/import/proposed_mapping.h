#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/formats/import/import_kind.h"
#include "abbe/formats/import/import_mapping.h"
#include "abbe/formats/import/table_layout.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// A tracker's readings without names of columns, taken as azimuth, elevation and range instead of coordinates.
struct PolarOrder {
  bool range_first = false;             ///< range, azimuth, elevation
  std::string angle_unit, length_unit;  ///< of azimuth and elevation, and of range; empty: by their ranges
};

/// What the caller knows of a table. What is given is no longer in doubt.
struct ImportHints {
  LayoutHints layout{};
  std::string length_unit{}, angle_unit{};  ///< of columns that state none, such as "inch" and "gon"; empty: not known
  std::optional<bool> clockwise{};          ///< azimuths count clockwise, seen from above
  std::optional<bool> zenith{};             ///< vertical angles count from the zenith
  std::string mirrored{};             ///< coordinate of a left-handed frame to be reversed: "x", "y" or "z"; or empty
  std::optional<PolarOrder> polar{};  ///< to be tried; only of columns without names
};

/// A column with the reason why it is read so.
struct ProposedColumn {
  MappedColumn column;
  std::size_t source = 0;           ///< column of the file, from 0
  std::string reason;               ///< one sentence
  std::vector<std::string> doubts;  ///< what nothing in the file decides, a sentence each; empty: certain
  /// Likewise about the sense of the frame, right-handed or left-handed, which the commands of a machine may decide.
  std::string sense_doubt{};
};

struct ProposedMapping {
  ImportKind kind = ImportKind::points;
  std::string reason;  ///< for the kind
  std::vector<ProposedColumn> columns;
  std::vector<std::string> not_read;  ///< other columns of the file, in words
};

/// Proposes where each column of a kind comes from: by the names in the header, the units and what the rows hold.
/// @param kind     absent: the one whose columns are all there
/// @param machine  null: no tracker
/// @throws InputError if a column that is needed is not found, if no kind or more than one fits, and for a unit that
///   does not belong to its column
ProposedMapping propose_mapping(std::string_view text, const std::string& file, const FoundLayout& found,
                                std::optional<ImportKind> kind, const Machine* machine, const ImportHints& hints = {});

}  // namespace abbe
