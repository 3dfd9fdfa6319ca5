#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "abbe/compensate/tables/axis_table.h"
#include "abbe/formats/controls/table_axis_names.h"

namespace abbe {

/// Compensation-value table *.COM of a HEIDENHAIN control: one axis's position (AXISPOS) in mm or degrees, one column
/// per axis that depends on it, 6 decimals of mm and 7 of degrees. Only names and meaning of the columns are
/// documented; head and end of the text (BEGIN ... MM, NR, [END]) are those of the control's other tables. Source:
/// HEIDENHAIN Technical Manual MANUALplus 620, "Entering compensation values"; TNC 407 (at most 256 entries).
/// @param tables  of one input axis, with the same positions, forward = reverse
/// @param sign    the value is sign * correction
std::string heidenhain_com_text(const std::vector<AxisTable>& tables, const std::vector<TableAxisName>& axes,
                                double sign);

/// @param input  axis whose position AXISPOS is: the file does not say it
/// @throws InputError for unknown columns (BACKLASH too), rows of wrong length, positions that do not increase
std::vector<AxisTable> parse_heidenhain_com(std::string_view text, const std::string& file, std::size_t input,
                                            const std::vector<TableAxisName>& axes, double sign);

inline constexpr std::size_t kHeidenhainPoints = 256;

/// A table that is in force for an axis.
struct HeidenhainAssignment {
  std::string column;  ///< what the control calls the axis
  std::string file;
};
/// CONFIG.CMA: one row of tables, the active one.
std::string heidenhain_assignment_text(const std::vector<HeidenhainAssignment>& tables);

}  // namespace abbe
