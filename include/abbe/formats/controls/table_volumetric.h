#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "abbe/compensate/tables/error_tables.h"
#include "abbe/formats/controls/table_axis_names.h"

namespace abbe {

/// Errors for the volumetric compensation of ISG and Beckhoff controls (TF5280), file format ISG_CSV: blocks with a
/// header of the axis and its error motions ("X EXX EYX EZX EAX EBX ECX"), one row per node, fields between blanks; one
/// block of position errors ("C0Y A0Z"); blocks end with "#", "//" begins a comment. Positions in mm and degrees,
/// values in mm and rad with 9 and 12 decimals, actual minus nominal.
/// Source: Beckhoff TF5280 TwinCAT 3 CNC Volumetric Compensation, "ISG CSV format", "Units of measure", "List of
/// parameters supported".
/// @param axes  single letters X Y Z A B C
std::string isg_csv_text(const ErrorTables& tables, const std::vector<TableAxisName>& axes);
/// @throws InputError for unknown columns, rows of wrong length, positions that do not increase (so for errors of two
///         arguments too), an error given twice
ErrorTables parse_isg_csv(std::string_view text, const std::string& file, const std::vector<TableAxisName>& axes);

/// The same errors in the exchange format of Etalon, variant "Vendor", as ISG controls read it: "[EXY]", "Gridpoints =
/// {", rows of position and value, "}"; position errors "[C0B]", "VALUE = 0.00002".
/// Source: the same manual, "Etalon Exchange Format".
std::string etalon_text(const ErrorTables& tables, const std::vector<TableAxisName>& axes);
/// @returns one table per error motion, in the order of the file
ErrorTables parse_etalon(std::string_view text, const std::string& file, const std::vector<TableAxisName>& axes);

}  // namespace abbe
