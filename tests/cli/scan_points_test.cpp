#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "cli/command_test.h"

namespace abbe {
namespace {

class ScanPoints : public CommandTest {
 protected:
  const std::string examples = std::string(ABBE_SOURCE_DIR "/examples/");
  const std::string machine = examples + "machines/liu-scanner.machine.toml";
  const std::string readings = examples + "cradle_scanner/readings.csv";
  const std::string errors = examples + "cradle_scanner/stages.errors.toml";

  /// Largest less smallest distance of the points from the y axis, mm.
  double spread(const std::string& file) const {
    std::istringstream stream(folder.read(file));
    std::string line;
    std::getline(stream, line);
    EXPECT_EQ(line, "x_mm,y_mm,z_mm");
    double lowest = 1e9, highest = 0;
    while (std::getline(stream, line)) {
      double x = 0, y = 0, z = 0;
      EXPECT_EQ(std::sscanf(line.c_str(), "%lf,%lf,%lf", &x, &y, &z), 3);
      lowest = std::min(lowest, std::hypot(x, z));
      highest = std::max(highest, std::hypot(x, z));
    }
    return highest - lowest;
  }
};

TEST_F(ScanPoints, ReadsTheExampleWithAndWithoutTheErrorsOfTheStages) {
  const CommandResult with =
      abbe({"scan", "points", readings, "--machine", machine, "--errors", errors, "-o", "p.csv", "--json"});
  ASSERT_EQ(with.exit_code, ExitCode::done) << with.err;
  const nlohmann::json json = nlohmann::json::parse(with.out);
  EXPECT_EQ(json["readings"], 468);
  EXPECT_EQ(json["points"], 468);
  const CommandResult without = abbe({"scan", "points", readings, "--machine", machine, "-o", "q.csv"});
  ASSERT_EQ(without.exit_code, ExitCode::done) << without.err;
  EXPECT_NE(without.out.find("machine without errors"), std::string::npos);
  // Accuracy is tested elsewhere; here the errors of the stages, up to 0.7 mm, must show.
  EXPECT_LT(spread("p.csv"), 2.5);
  EXPECT_GT(std::abs(spread("p.csv") - spread("q.csv")), 0.1);
  const CommandResult ply = abbe({"scan", "points", readings, "--machine", machine, "-o", "p.ply",
                                  "--indication-range-mm", "-0.01", "0.01", "--json"});
  ASSERT_EQ(ply.exit_code, ExitCode::done) << ply.err;
  const nlohmann::json left = nlohmann::json::parse(ply.out);
  EXPECT_GT(left["outside_indication_range"].get<int>(), 0);
  EXPECT_EQ(left["points"].get<int>() + left["outside_indication_range"].get<int>(), 468);
  EXPECT_EQ(folder.read("p.ply").substr(0, 4), "ply\n");
}

TEST_F(ScanPoints, WhatIsWrongIsNamedAndNothingIsWritten) {
  folder.write("r.csv", "C_deg,A_deg,X_mm,Y_mm,Z_mm,indication_mm\n0,0,0,0,0,0\n0,0,500,0,0,0\n");
  const CommandResult travel = abbe({"scan", "points", "r.csv", "--machine", machine, "-o", "p.csv"});
  EXPECT_EQ(travel.exit_code, ExitCode::bad_input);
  EXPECT_NE(travel.err.find("r.csv:3"), std::string::npos) << travel.err;
  EXPECT_NE(travel.err.find("outside the travel of axis X"), std::string::npos) << travel.err;
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "p.csv"));
  EXPECT_EQ(abbe({"scan", "points", "r.csv", "--machine", machine, "-o", "p.csv", "--any-travel"}).exit_code,
            ExitCode::done);
  const CommandResult column =
      abbe({"scan", "points", "r.csv", "--machine", machine, "--force", "-o", "p.csv", "--column", "indication_um=h"});
  EXPECT_EQ(column.exit_code, ExitCode::bad_input);
  EXPECT_EQ(abbe({"scan", "points", "r.csv", "--machine", machine, "-o", "p.xyz"}).exit_code, ExitCode::bad_input);
  EXPECT_EQ(abbe({"scan", "points", "r.csv", "--machine", machine, "--force", "-o", "p.csv", "--beam", "0", "0", "0"})
                .exit_code,
            ExitCode::bad_input);
  EXPECT_EQ(abbe({"scan", "points", "r.csv", "--machine", machine, "--force", "-o", "p.csv", "--any-travel",
                  "--indication-range-mm", "1", "2"})
                .exit_code,
            ExitCode::computation_says_no);
}

TEST_F(ScanPoints, ReadingsWhereTheErrorsAreNotKnownAreLeftOutAndTold) {
  folder.write("e.errors.toml", R"(chain = "w C A X' Y' b Z t"
[[motion]]
name = "EXX"
basis = "monomial"
order = 1
from_mm = -10
to_mm = 10
coefficients_um = [0, 1]
)");
  folder.write("r.csv", "C_deg,A_deg,X_mm,Y_mm,Z_mm,indication_mm\n0,0,0,0,0,0\n0,0,5,0,0,0\n0,0,15,0,0,0\n");
  const std::vector<std::string> points = {"scan",     "points",        "r.csv",   "--machine", machine,
                                           "--errors", "e.errors.toml", "--force", "-o",        "p.csv"};
  const CommandResult told = abbe(points);
  EXPECT_EQ(told.exit_code, ExitCode::computation_says_no) << told.err;
  EXPECT_NE(told.err.find("abbe: 1 of 3 readings lies outside the range in which the errors are known; it is left out "
                          "(--accept-uncovered: exit code 0)\n"),
            std::string::npos)
      << told.err;
  std::vector<std::string> accepted = points;
  accepted.emplace_back("--accept-uncovered");
  EXPECT_EQ(abbe(accepted).exit_code, ExitCode::done);
  // No points at all are no result, whatever is accepted.
  folder.write("r.csv", "C_deg,A_deg,X_mm,Y_mm,Z_mm,indication_mm\n0,0,15,0,0,0\n");
  const CommandResult none = abbe(accepted);
  EXPECT_EQ(none.exit_code, ExitCode::computation_says_no);
  EXPECT_EQ(none.err.find("probe's range"), std::string::npos) << none.err;
}

}  // namespace
}  // namespace abbe
