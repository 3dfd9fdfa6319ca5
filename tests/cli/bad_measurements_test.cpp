#include <gmock/gmock.h>

#include <csignal>
#include <nlohmann/json.hpp>

#include "cli/command_test.h"
#include "cli/machine_for_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;

const std::string kMeasuredStudy = std::string(R"(machine = "m.toml"
output = "out"
[[setup]]
name = "tracker"
instrument = "tracker"
noise = { xyz_um = 10 }
)") + kThreeReflectors + R"([[setup.data]]
file = "r.csv"
[identify]
[[identify.motion]]
errors = ["E?X", "E?Z"]
basis = "legendre"
order = 1
)";

/// What happens to a study whose measurement file is not as it should be.
class BadMeasurements : public CommandTest {
 protected:
  BadMeasurements() {
    folder.write("m.toml", kTableXColumnZ);
    folder.write("s.study.toml", kMeasuredStudy);
    folder.write("r.csv", good());
  }

  /// Readings of an exact machine by a tracker whose frame is turned by nothing.
  static std::string good() {
    const double offsets[3][3] = {{60, 0, -150}, {0, 80, -250}, {-70, -30, -100}};
    std::string text = "X_mm,Z_mm,reflector,measured_x_mm,measured_y_mm,measured_z_mm\n";
    for (int i = 0; i < 7; ++i)
      for (int k = 0; k < 5; ++k)
        for (int r = 0; r < 3; ++r) {
          const int x = 200 * i, z = 150 * k;
          text += std::to_string(x) + "," + std::to_string(z) + ",R" + std::to_string(r + 1) + "," +
                  std::to_string(offsets[r][0] + x) + "," + std::to_string(offsets[r][1]) + "," +
                  std::to_string(offsets[r][2] + z) + "\n";
        }
    return text;
  }

  /// Replaces one passage of the good file.
  void write_changed(const std::string& from, const std::string& to) const {
    std::string text = good();
    ASSERT_NE(text.find(from), std::string::npos) << from;
    folder.write("r.csv", text.replace(text.find(from), from.size(), to));
  }

  void expect_refused(const std::string& message) const {
    const CommandResult result = abbe({"run", "s.study.toml"});
    EXPECT_EQ(result.exit_code, ExitCode::bad_input) << result.out;
    EXPECT_EQ(result.out, "");
    EXPECT_THAT(result.err, HasSubstr(message));
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "out"));
  }

  /// Everything but the time in the summary of a run.
  nlohmann::json summary() const {
    const CommandResult result = abbe({"run", "s.study.toml", "--json"});
    EXPECT_EQ(result.exit_code, ExitCode::done) << result.err;
    return nlohmann::json::parse(result.out, nullptr, false);
  }
};

TEST_F(BadMeasurements, AreRefusedWithFileLineFieldAndUnit) {
  write_changed("measured_x_mm", "measured_x_deg");
  expect_refused(
      "r.csv:1:21: measured_x_deg: 'deg' is not a unit of a length; expected measured_x_mm, measured_x_um or "
      "measured_x_m");
  write_changed("Z_mm", "Z");
  expect_refused("r.csv:1:6: Z: the unit is missing from the name of this column; expected Z_mm, Z_um or Z_m");
  write_changed("Z_mm", "Y_mm");
  expect_refused("r.csv:1:6: Y_mm: unknown column");
  write_changed("Z_mm", "X_um");
  expect_refused("r.csv:1:6: X_um: says the same as column X_mm");
  write_changed("Z_mm", "X_mm");
  expect_refused("r.csv:1:6: X_mm: this column is given twice");
  write_changed("0,150,R1", "0,nan,R1");
  expect_refused("r.csv:5:3: Z_mm: 'nan' is not a finite number; expected a length in mm");
  write_changed("0,150,R1", "0,1e308,R1");
  expect_refused("r.csv:5:3: Z_mm: '1e308' is too large; expected a length in mm");
  write_changed("0,150,R1", "0,601,R1");
  expect_refused("r.csv:5: Z_mm: 601 mm is outside the travel of axis Z; expected 0 to 600 mm");
  write_changed("0,150,R1", "0,R1");
  expect_refused("r.csv:5:3: Z_mm: 'R1' is not a number; expected a length in mm");
  write_changed("0,150,R1", "0,150,R4");
  expect_refused("r.csv: reflector: reflector 'R4' is not in the study");
  folder.write("r.csv", "");
  expect_refused("r.csv: the file is empty");
  std::string without = good();
  for (std::size_t at = 0; (at = without.find(',', at)) != std::string::npos;) {
    const std::size_t second = without.find_first_of(",\n", at + 1), line_end = without.find('\n', at);
    without.erase(at, second - at);
    at = without.find('\n', at);
    if (line_end == std::string::npos || at == std::string::npos) break;
  }
  folder.write("r.csv", without);
  expect_refused("r.csv:1: Z: missing column; expected Z_mm, Z_um or Z_m");
}

TEST_F(BadMeasurements, DecimalCommasAreNotTakenForColumns) {
  write_changed("0,150,R1", "0,5,150,R1");
  expect_refused("r.csv:5:");
  std::string text = good();
  for (char& c : text) c = c == ',' ? ';' : c == '.' ? ',' : c;
  folder.write("r.csv", text);
  expect_refused(
      "the columns are not separated by commas; expected commas between columns and a decimal point (abbe import "
      "converts other tables)");
}

TEST_F(BadMeasurements, ByteOrderMarkAndCarriageReturnsChangeNothing) {
  const nlohmann::json plain = summary();
  std::string text = "\xEF\xBB\xBF";
  for (const char c : good()) text += c == '\n' ? std::string("\r\n") : std::string(1, c);
  folder.write("r.csv", text);
  EXPECT_EQ(summary(), plain);
  EXPECT_LT(plain["chi_square"], 1e-3);
}

TEST_F(BadMeasurements, AnAxisThatStandsTwiceInTheChainIsRefused) {
  std::string text = kTableXColumnZ;
  folder.write("m.toml", text.replace(text.find("b Z t"), 5, "b X t"));
  expect_refused("m.toml:2:");
}

TEST_F(BadMeasurements, AFullDiskLeavesTheOldResults) {
  ASSERT_EQ(abbe({"run", "s.study.toml"}).exit_code, ExitCode::done);
  const std::string old_page = folder.read("out/report.html"), old_errors = folder.read("out/errors.toml");
  write_changed("0,150,R1", "0,150.01,R1");
  // Files end at 64 blocks of 512 bytes, less than the page has.
  ASSERT_GT(old_page.size(), 64U * 512);
  const CommandResult full = run_program(
      "/bin/sh", {"-c", "trap '' XFSZ; ulimit -f 64; exec \"$0\" run s.study.toml", ABBE_COMMAND}, folder.path());
  EXPECT_EQ(full.exit_code, ExitCode::bad_input) << full.err;
  EXPECT_THAT(full.err, HasSubstr("cannot be written"));
  EXPECT_EQ(folder.read("out/report.html"), old_page);
  EXPECT_EQ(folder.read("out/errors.toml"), old_errors);
}

TEST_F(BadMeasurements, ARunKilledAtAnyTimeLeavesTheOldResultsOrTheNewOnes) {
  // A machine without errors is no better corrected.
  ASSERT_EQ(abbe({"run", "s.study.toml", "--accept-misfit"}).exit_code, ExitCode::done);
  const std::string old_page = folder.read("out/report.html"), old_errors = folder.read("out/errors.toml");
  write_changed("0,150,R1", "0,150.001,R1");
  ASSERT_EQ(abbe({"run", "s.study.toml", "--accept-misfit", "-o", "new"}).exit_code, ExitCode::done);
  const std::string new_page = folder.read("new/report.html"), new_errors = folder.read("new/errors.toml");
  ASSERT_NE(old_errors, new_errors);
  int killed = 0;
  for (const char* after_s : {"0.01", "0.02", "0.03", "0.04", "0.06", "0.08", "0.11", "0.15"}) {
    const CommandResult result =
        run_program("/usr/bin/timeout", {"-s", "KILL", after_s, ABBE_COMMAND, "run", "s.study.toml", "--accept-misfit"},
                    folder.path());
    killed += result.exit_code == 128 + SIGKILL;
    const std::string page = folder.read("out/report.html"), errors = folder.read("out/errors.toml");
    EXPECT_TRUE((page == old_page && errors == old_errors) || (page == new_page && errors == new_errors)) << after_s;
  }
  EXPECT_GT(killed, 0);
  EXPECT_EQ(abbe({"run", "s.study.toml", "--accept-misfit"}).exit_code, ExitCode::done);
  EXPECT_EQ(folder.read("out/errors.toml"), new_errors);
}

}  // namespace
}  // namespace abbe
