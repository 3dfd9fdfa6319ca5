#pragma once

#include <string>
#include <vector>

#include "abbe/formats/text/csv_reader.h"

namespace abbe {

class Subcommand;

/// Names of columns in a CSV file that abbe did not write: --column NAME_unit=COLUMN, --ignore COLUMN.
struct ColumnOptions {
  std::vector<std::string> columns, ignore;

  /// @throws InputError for a text that is not understood, and for a name that is given twice
  ColumnMapping mapping() const;
};

/// Adds both options. @param example  of a column, for --help: "indication_um=h"
void add_columns(Subcommand* command, ColumnOptions& options, const std::string& example);

}  // namespace abbe
