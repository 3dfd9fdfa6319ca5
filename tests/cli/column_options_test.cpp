// --column and --ignore: a file with other names and more columns gives the answers of the same file with abbe's names.
#include <gmock/gmock.h>

#include <filesystem>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "cli/command_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;

/// A command that reads a CSV file of examples/ as `{}`, and the column that is renamed in it.
struct RenamedColumn {
  std::string name;  ///< of the test
  std::string file;
  std::string ours, theirs;
  std::vector<std::string> arguments;
};

void PrintTo(const RenamedColumn& test, std::ostream* out) { *out << test.name; }

class ColumnOptions : public CommandTest, public testing::WithParamInterface<RenamedColumn> {
 protected:
  CommandResult run(std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments = GetParam().arguments;
    for (std::string& argument : arguments) {
      if (argument == "{}") argument = "readings.csv";
      if (argument.starts_with("examples/")) argument = std::string(ABBE_SOURCE_DIR "/") + argument;
    }
    for (std::string& argument : more) arguments.push_back(std::move(argument));
    return abbe(arguments);
  }
};

/// The table with one column called otherwise, and one more in front.
std::string with_other_names(const std::string& table, const std::string& ours, const std::string& theirs) {
  std::istringstream stream(table);
  std::string result;
  bool is_header = true;
  for (std::string line; std::getline(stream, line);) {
    if (!line.empty() && line[0] != '#') {
      if (is_header) {
        const std::size_t at = ("," + line + ",").find("," + ours + ",");
        EXPECT_NE(at, std::string::npos) << line;
        line.replace(at, ours.size(), theirs);
      }
      line.insert(0, is_header ? "remark," : "\"seen, and kept\",");
      is_header = false;
    }
    result += line + "\n";
  }
  return result;
}

std::string contents_of_example(const std::string& file) {
  const TemporaryFolder folder;
  std::filesystem::copy(std::filesystem::path(ABBE_SOURCE_DIR) / "examples" / file, folder.path() / "copy");
  return folder.read("copy");
}

TEST_P(ColumnOptions, GiveTheAnswerOfTheFileWithOurNames) {
  const RenamedColumn& test = GetParam();
  const std::string table = contents_of_example(test.file);
  folder.write("readings.csv", table);
  const CommandResult as_ours = run();
  ASSERT_THAT(as_ours.exit_code, testing::AnyOf(ExitCode::done, ExitCode::computation_says_no)) << as_ours.err;

  folder.write("readings.csv", with_other_names(table, test.ours, test.theirs));
  const CommandResult renamed = run({"--column", test.ours + "=" + test.theirs, "--ignore", "remark"});
  EXPECT_EQ(renamed.exit_code, as_ours.exit_code) << renamed.err;
  EXPECT_EQ(renamed.out, as_ours.out);

  const CommandResult unread = run({"--column", test.ours + "=" + test.theirs});
  EXPECT_EQ(unread.exit_code, ExitCode::bad_input);
  EXPECT_THAT(unread.err, HasSubstr("remark"));
  EXPECT_THAT(unread.err, HasSubstr("--ignore"));
  const CommandResult missing =
      run({"--column", test.ours + "=elsewhere", "--ignore", "remark", "--ignore", test.theirs});
  EXPECT_EQ(missing.exit_code, ExitCode::bad_input);
  EXPECT_THAT(missing.err, HasSubstr("there is no such column to be read as " + test.ours));
}

INSTANTIATE_TEST_SUITE_P(
    Commands, ColumnOptions,
    testing::Values(
        RenamedColumn{
            "positioning", "evaluate/linear.csv", "deviation_um", "error", {"evaluate", "positioning", "{}", "--json"}},
        RenamedColumn{
            "diagonals", "evaluate/diagonals.csv", "target_mm", "L", {"evaluate", "diagonals", "{}", "--json"}},
        RenamedColumn{"circular",
                      "evaluate/circular.csv",
                      "deviation_um",
                      "dr",
                      {"evaluate", "circular", "{}", "--radius-mm", "150", "--json"}},
        RenamedColumn{"rotation", "evaluate/rotation.csv", "x1_um", "ch1", {"evaluate", "rotation", "{}", "--json"}},
        RenamedColumn{"straightness",
                      "evaluate/straightness.csv",
                      "position_mm",
                      "at",
                      {"evaluate", "straightness", "{}", "--json"}},
        RenamedColumn{"etve", "evaluate/etve.csv", "Z_um", "probe", {"evaluate", "etve", "{}", "--json"}},
        RenamedColumn{
            "squareness", "evaluate/squareness.csv", "line", "arm", {"evaluate", "squareness", "{}", "--json"}},
        RenamedColumn{
            "sections", "laser_engraver/sections.csv", "height_mm", "z", {"evaluate", "contour", "{}", "--json"}},
        RenamedColumn{"contour_points",
                      "laser_engraver/engraved.csv",
                      "x_mm",
                      "East",
                      {"evaluate", "contour", "{}", "--curve", "examples/laser_engraver/table-a4.csv", "--json"}},
        RenamedColumn{"linkage",
                      "laser_engraver/five-steps.csv",
                      "width_um",
                      "w",
                      {"evaluate", "linkage", "{}", "--exit-to-axis-mm", "120", "--board-mm", "4", "--json"}},
        RenamedColumn{"fit", "fit/bore.csv", "z_mm", "Height", {"fit", "{}", "--shape", "cylinder", "--json"}},
        RenamedColumn{"register",
                      "scan/bracket-scan.csv",
                      "y_mm",
                      "North",
                      {"register", "{}", "examples/scan/bracket.stl", "--json"}},
        RenamedColumn{
            "deviate",
            "scan/pin-scan.csv",
            "y_mm",
            "North",
            {"deviate", "{}", "examples/scan/pin.stl", "--transform", "examples/scan/pin-transform.csv", "--json"}}),
    [](const testing::TestParamInfo<RenamedColumn>& test) { return test.param.name; });

class ColumnOptionsRefused : public CommandTest {};

TEST_F(ColumnOptionsRefused, AFileWithoutNamesOfColumns) {
  folder.write("points.xyz", "0 0 0\n1 0 0\n0 1 0\n1 1 0.1\n");
  for (const std::vector<std::string>& option :
       {std::vector<std::string>{"--column", "x_mm=East"}, std::vector<std::string>{"--ignore", "remark"}}) {
    std::vector<std::string> arguments = {"fit", "points.xyz", "--shape", "plane"};
    arguments.insert(arguments.end(), option.begin(), option.end());
    const CommandResult result = abbe(arguments);
    EXPECT_EQ(result.exit_code, ExitCode::bad_input);
    EXPECT_EQ(result.err,
              "abbe: points.xyz: its columns cannot be named or left out: this is not a CSV file; expected a CSV file, "
              "whose first line has the names of its columns\n");
  }
}

TEST_F(ColumnOptionsRefused, TextsThatAreNoPairAndNamesGivenTwice) {
  folder.write("points.csv", "East,y_mm,z_mm\n0,0,0\n1,0,0\n0,1,0\n");
  for (const std::string text : {"x_mm", "=East", "x_mm="}) {
    const CommandResult result = abbe({"fit", "points.csv", "--shape", "plane", "--column", text});
    EXPECT_EQ(result.exit_code, ExitCode::bad_input);
    EXPECT_THAT(result.err, HasSubstr("--column " + text + ": not understood; expected NAME_unit=COLUMN"));
  }
  const CommandResult twice =
      abbe({"fit", "points.csv", "--shape", "plane", "--column", "x_mm=East", "--column", "x_mm=y_mm"});
  EXPECT_EQ(twice.exit_code, ExitCode::bad_input);
  EXPECT_THAT(twice.err, HasSubstr("--column x_mm=y_mm: this name is given twice"));
}

}  // namespace
}  // namespace abbe
