// The example of docs/controller-tables.md is the one below, and it does what the page says.
#include <gtest/gtest.h>

#include <cctype>
#include <filesystem>
#include <iostream>
#include <string>

#include "abbe/controls/control_table.h"
#include "abbe/formats/files/empty_folder_for_test.h"
#include "abbe/formats/files/results_folder.h"
#include "abbe/formats/files/text_file.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/machine/machine_file.h"

namespace abbe::test {
namespace {

// clang-format off
void documented_example() {
  // begin
  abbe::ControlTableRequest request;
  request.format = "siemens-cec";
  request.machine = abbe::read_machine("mill.machine.toml");
  request.errors = abbe::read_errors("mill.errors.toml", request.machine).errors;
  request.limit_mm = 0.1;
  const abbe::ControlTables made = abbe::make_control_tables(request);
  for (const std::string& why : made.refused) std::cerr << why << '\n';
  for (const abbe::ControlFile& file : made.files) abbe::write_file_atomically(file.name, file.text);
  // end
}
// clang-format on

/// What stands between two marks, with the blanks at the beginnings of lines taken away.
std::string lines_between(const std::string& text, const std::string& begin, const std::string& end) {
  const std::size_t from = text.find(begin) + begin.size(), to = text.find(end, from);
  std::string lines;
  bool at_beginning = true;
  for (const char c : text.substr(from, to - from)) {
    if (at_beginning && c == ' ') continue;
    at_beginning = c == '\n';
    lines += c;
  }
  return lines;
}

TEST(DocumentedExample, OfTablesIsTheOneThatIsCompiledAndWritesThem) {
  const std::filesystem::path source = ABBE_SOURCE_DIR;
  const std::string page = read_text_file(source / "docs/controller-tables.md");
  const std::string code = read_text_file(source / "src/abbe/controls/documented_example_test.cpp");
  EXPECT_EQ(lines_between(page, "```cpp\n", "```"), lines_between(code, "// begin\n", "// end\n"));

  const std::filesystem::path folder = empty_folder("abbe_documented_tables"), here = std::filesystem::current_path();
  std::filesystem::copy(source / "examples/machines/three-axis-mill.machine.toml", folder / "mill.machine.toml");
  std::filesystem::copy(source / "examples/compensate/mill.errors.toml", folder / "mill.errors.toml");
  std::filesystem::current_path(folder);
  documented_example();
  std::filesystem::current_path(here);
  EXPECT_EQ(read_text_file(folder / "CEC.INI").find("%_N_NC_CEC_INI"), 0U);
}

}  // namespace
}  // namespace abbe::test
