#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/compensate/tables/axis_table.h"
#include "abbe/formats/controls/table_axis_names.h"

namespace abbe {

/// A column C1 to C6 of the compensation-value table of an axis.
struct ComptabColumn {
  std::size_t axis = 0;    ///< index into Machine::axes
  std::size_t column = 0;  ///< 0 to 5: C1 to C6
  bool operator==(const ComptabColumn&) const = default;
};

/// A row of the kinematics description of a HEIDENHAIN control.
struct KinematicsRow {
  enum class Key { trans, mach_axis, mach_base };
  Key key = Key::trans;
  char axis = ' ';                        ///< AXIS: X Y Z U V W A B C; blank for MachBase
  std::string doc{};                      ///< comment of at most kKinematicsDoc characters
  std::optional<double> coord{};          ///< COORD, mm or rad
  std::optional<double> constant{};       ///< COMPTAB, a number that is added; mm or rad
  std::optional<ComptabColumn> column{};  ///< COMPTAB, a column that is added
  bool operator==(const KinematicsRow&) const = default;
};
inline constexpr std::size_t kKinematicsDoc = 14;
/// Rows of the description that have a transformation or an axis in COORD, at most.
inline constexpr std::size_t kKinematicsCoordRows = 50;
/// Entries of COMPTAB and rows MachAxis together, at most.
inline constexpr std::size_t kKinematicsComptabRows = 100;

/// 0 to 5 for X Y Z A B C, with U V W as X Y Z; 6 for any other letter.
std::size_t kinematics_coordinate(char letter);

/// What counts against the two limits above: rows Trans with a number in COORD, and rows MachAxis; entries of COMPTAB.
struct KinematicsCount {
  std::size_t coord = 0, axes = 0, comptab = 0;
};
KinematicsCount kinematics_count(const std::vector<KinematicsRow>& rows);
/// "4 of 97 entries in COMPTAB, 3 of 50 rows with COORD or MachAxis".
std::string kinematics_room(const KinematicsCount& count);
/// Whether both limits are kept.
bool kinematics_fits(const KinematicsCount& count);

/// Kinematics description of a HEIDENHAIN control: NR DOC KEY AXIS COORD COMPTAB, from the tool reference point to the
/// table. COORD and numbers of COMPTAB in mm with 6 decimals or degrees with 7; a reference to a column is "A1C2" with
/// the number of the axis. Source: HEIDENHAIN Technical Manual iTNC 530 HSCI, July 2013, pages 670, 671, 684, 686, 722
/// (docs/controller-tables.md says what those pages leave open).
/// @param file  name of the table, in its first line
/// @param axes  names are the numbers of axes
/// @param sign  numbers of COMPTAB are sign * constant
std::string heidenhain_kinematics_text(const std::vector<KinematicsRow>& rows, const std::string& file,
                                       const std::vector<TableAxisName>& axes, double sign);

/// @throws InputError for other keys and columns, since they would change the chain; references to unknown axes; a
///   column in mm for an angle or the other way round
std::vector<KinematicsRow> parse_heidenhain_kinematics(std::string_view text, const std::string& file,
                                                       const std::vector<TableAxisName>& axes, double sign);

/// Compensation-value table *.COM of one axis with its own column and those of its component errors: C1 to C3 in mm,
/// C4 to C6 in degrees (the same manual, page 680).
struct ComponentTable {
  std::size_t axis = 0;                             ///< whose position is looked up; `input` of all tables below
  std::optional<AxisTable> own;                     ///< correction of the command of the axis itself, mm or rad
  std::array<std::optional<AxisTable>, 6> columns;  ///< mm or rad; `output` unused; the same positions as `own`
};

/// @param own_sign  the own column is own_sign * correction
/// @param sign      columns C1 to C6 are sign * value
std::string heidenhain_component_text(const ComponentTable& table, const std::string& file,
                                      const std::vector<TableAxisName>& axes, double own_sign, double sign);

/// @param axis  whose position AXISPOS is: the file does not say it
/// @throws InputError for columns of other axes (BACKLASH too), rows of wrong length, positions that do not increase
ComponentTable parse_heidenhain_component(std::string_view text, const std::string& file, std::size_t axis,
                                          const std::vector<TableAxisName>& axes, double own_sign, double sign);

}  // namespace abbe
