#include "column_options.h"

#include "abbe/formats/text/input_error.h"
#include "options.h"

namespace abbe {

ColumnMapping ColumnOptions::mapping() const {
  ColumnMapping mapping;
  for (const std::string& text : columns) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) {
      throw InputError({.field = "--column " + text}, "not understood", "NAME_unit=COLUMN, such as deviation_um=error");
    }
    if (!mapping.columns.emplace(text.substr(0, equals), text.substr(equals + 1)).second) {
      throw InputError({.field = "--column " + text}, "this name is given twice");
    }
  }
  mapping.ignore = ignore;
  mapping.ignored_by = "--ignore";
  return mapping;
}

void add_columns(Subcommand* command, ColumnOptions& options, const std::string& example) {
  command
      ->add_option("--column", options.columns,
                   "Column of a CSV file with a different name: NAME_unit=COLUMN, such as " + example + "; repeatable")
      ->expected(1)
      ->take_all();
  command->add_option("--ignore", options.ignore, "Column of a CSV file that is not read; repeatable")
      ->expected(1)
      ->take_all();
}

}  // namespace abbe
