#pragma once

#include <string>
#include <variant>
#include <vector>

#include "abbe/formats/text/csv_reader.h"

namespace abbe {

/// A column in memory instead of in a file; its name states the unit as in a file: "deviation_um", "direction".
struct NamedColumn {
  std::string name;
  /// [rows] numbers in the unit of the name, or names. NaN stands for an empty field, where a file may have one.
  std::variant<std::vector<double>, std::vector<std::string>> values;
};

using NamedColumns = std::vector<NamedColumn>;

/// The table that read_csv() would read from a file with these columns, its numbers written with all their digits.
/// @throws InputError as read_csv(), with rows counted from 0: "deviation_um[3]"; also for columns of different lengths
///   and for text in place of numbers
CsvTable table_of_columns(const NamedColumns& columns, const std::vector<CsvColumn>& wanted);

}  // namespace abbe
