#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/formats/text/unit.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// What a table of another program becomes.
enum class ImportKind {
  points,       ///< x, y, z: a point cloud, as abbe fit and abbe register read it
  tracker,      ///< commands of a machine and what a tracker measured there (measurement_file.h)
  positioning,  ///< deviations at target positions, as abbe evaluate positioning reads them
  circular,     ///< ball bar or grid encoder on a circle, as abbe evaluate circular reads them
  temperatures  ///< temperatures of sensors by time; nothing of Abbe reads them yet
};

/// "points", "tracker", "positioning", "circular", "temperatures".
std::string_view import_kind_name(ImportKind kind);
std::optional<ImportKind> import_kind_named(std::string_view name);
std::vector<std::string> import_kind_names();

/// How the numbers of a column become those of Abbe, beside their unit.
enum class ImportConvention {
  as_written,
  reversed,  ///< times -1: one coordinate of a left-handed frame, or a deviation counted as target less actual
  zenith,    ///< angles from the zenith become elevations: a quarter turn less the angle
  clockwise  ///< times -1: azimuths that count clockwise seen from above
};

/// "as-written", "reversed", "zenith", "clockwise".
std::string_view convention_name(ImportConvention convention);
std::vector<std::string_view> convention_names();

/// A column that Abbe reads.
struct ImportColumn {
  enum class Holds {
    number,
    name,       ///< a text that may not be empty
    label,      ///< a text of its own in every row, which may be empty
    direction,  ///< + or -
    rotation    ///< cw or ccw
  };
  std::string base;  ///< "measured_x"; a number's unit follows in the header
  Quantity quantity = Quantity::dimensionless;
  Holds holds = Holds::number;
  bool required = false;
  std::string group{};               ///< all columns of a group or none: "xyz"
  std::vector<std::string> words{};  ///< what other programs call it, in small letters, the surest first
  std::string exact_word{};          ///< what it is only called with these capitals: "X" beside "x"
};

/// Whether a column holds one of two directions.
inline bool holds_direction(const ImportColumn& column) {
  return column.holds == ImportColumn::Holds::direction || column.holds == ImportColumn::Holds::rotation;
}

/// The columns of a kind, in the order in which they are written. A base may be there with two quantities.
/// @param machine  of a tracker's commands; not used by other kinds
std::vector<ImportColumn> import_columns(ImportKind kind, const Machine& machine);

/// "x_mm" in the unit of a column: its header in files that Abbe reads.
std::string import_header(const ImportColumn& column, std::string_view suffix);

}  // namespace abbe
