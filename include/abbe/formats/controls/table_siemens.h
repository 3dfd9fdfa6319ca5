#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "abbe/compensate/tables/axis_table.h"
#include "abbe/formats/controls/table_axis_names.h"

namespace abbe {

/// SINUMERIK 840D/840D sl/828D/802D sl tables as initialisation files; mm and degrees, 6 decimals of mm, 7 of degrees.
///
/// Sag and angularity (CEC, `%_N_NC_CEC_INI`): a table per pair of axes, its value is ADDED to the position setpoint of
/// the output axis, looked up at the setpoint of the input axis: value = correction. Where forward and reverse differ,
/// two tables with $AN_CEC_DIRECTION 1 and -1.
/// Source: SINUMERIK Function Manual Extended Functions, K3 "Compensations", 6FC5397-1BP40-3BA1, 4.4.3.
/// @param first_table  index of the first table, from 0
std::string siemens_cec_text(const std::vector<AxisTable>& tables, const std::vector<TableAxisName>& axes,
                             std::size_t first_table);

/// @throws InputError for unknown names and axes, missing or repeated values, steps that do not fit to ends and count,
///         and products of tables ($AN_CEC_MULT_BY_TABLE other than 0)
std::vector<AxisTable> parse_siemens_cec(std::string_view text, const std::string& file,
                                         const std::vector<TableAxisName>& axes);

/// Encoder (leadscrew) error compensation (EEC, `%_N_AX_EEC_INI`): tables of an axis for itself. The value is added to
/// the ACTUAL position, so that a positive value moves the axis in the negative direction: value = error = -correction.
/// Source: the same manual, 4.4.2, and SINUMERIK 808D Function Manual 01/2017, LEC, for the sign.
/// @param encoder  index of the measuring system, 0 or 1
std::string siemens_eec_text(const std::vector<AxisTable>& tables, const std::vector<TableAxisName>& axes,
                             std::size_t encoder);
std::vector<AxisTable> parse_siemens_eec(std::string_view text, const std::string& file,
                                         const std::vector<TableAxisName>& axes);

}  // namespace abbe
