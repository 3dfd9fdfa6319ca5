#pragma once

#include <string>
#include <variant>
#include <vector>

#include "abbe/formats/text/csv_reader.h"

namespace abbe {

/// A column that a program gives instead of a file; its name says the unit as in a file: "deviation_um", "direction".
struct NamedColumn {
  std::string name;
  /// [rows] in the unit of the name, or names; NaN where a field of a file may be empty.
  std::variant<std::vector<double>, std::vector<std::string>> values;
};

using NamedColumns = std::vector<NamedColumn>;

/// The table that read_csv() reads from a file with these columns, in which each number stands with as many digits as
/// it has.
/// @throws InputError as read_csv(); a row is named by its index from 0: "deviation_um[3]". Also for columns of
///   different lengths and for texts in place of numbers
CsvTable table_of_columns(const NamedColumns& columns, const std::vector<CsvColumn>& wanted);

}  // namespace abbe
