#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "abbe/controls/control_table.h"
#include "abbe/controls/table_text.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/machine/machine_file.h"

namespace abbe {
namespace {

using testing::HasSubstr;

const WorkpieceExpansion kWarmCasting{.temperature = 27,
                                      .coefficient = 11e-6,
                                      .standard_uncertainty = 1e-6,
                                      .temperature_uncertainty = 0.5,
                                      .fixed_point = {200, 100, 0}};
constexpr double kStrainOfCasting = 11e-6 * 7;

ControlTableRequest warm_table(const ErrorSet& errors) {
  ControlTableRequest request;
  request.format = "linuxcnc";
  request.machine = read_machine(std::string(ABBE_SOURCE_DIR) + "/examples/machines/three-axis-mill.machine.toml");
  request.errors = errors;
  request.positions = 3;
  request.workpiece = kWarmCasting;
  return request;
}

std::vector<std::pair<double, double>> nodes_of(const ControlTables& made, const std::string& name) {
  std::vector<std::pair<double, double>> nodes;
  for (const ControlFile& file : made.files) {
    if (file.name != name) continue;
    std::istringstream lines(file.text);
    for (std::string line; std::getline(lines, line);) {
      double position = 0, forward = 0;
      if (std::istringstream(line) >> position >> forward) nodes.emplace_back(position, forward);
    }
  }
  return nodes;
}

TEST(TablesForAWarmWorkpiece, CarryItsExpansionOfEveryAxis) {
  const ControlTables made = make_control_tables(warm_table({}));
  ASSERT_FALSE(made.says_no()) << testing::PrintToString(made.refused);
  for (const char* const name : {"X.comp", "Y.comp", "Z.comp"}) {
    const auto nodes = nodes_of(made, name);
    ASSERT_GE(nodes.size(), 2U) << name;
    const double change = nodes.back().second - nodes.front().second;
    const double length = nodes.back().first - nodes.front().first;
    // The tool goes farther than commanded by the strain of the part.
    EXPECT_NEAR(std::abs(change), kStrainOfCasting * length, 2e-7 + 1e-4 * std::abs(change)) << name;
  }
  // The simulated control: what is left with the tables against what there is without.
  EXPECT_GT(made.before.position_statistics.maximum, 0.02);
  EXPECT_LT(made.after.position_statistics.maximum, 2e-4);
  ASSERT_TRUE(made.uncertainty);
  const double u = std::sqrt(strain_variance(kWarmCasting, 7)) / kStrainOfCasting;
  EXPECT_NEAR(made.uncertainty->maximum / made.before.position_statistics.maximum, u, 0.01 * u);
}

TEST(TablesForAWarmWorkpiece, AreThoseOfTheErrorsAndOfThePartTogether) {
  ControlTableRequest request = warm_table({});
  request.errors =
      read_errors(std::string(ABBE_SOURCE_DIR) + "/examples/compensate/mill.errors.toml", request.machine).errors;
  const ControlTables both = make_control_tables(request);
  request.workpiece.reset();
  const ControlTables of_errors = make_control_tables(request);
  EXPECT_FALSE(of_errors.workpiece);
  EXPECT_LT(both.after.position_statistics.maximum, of_errors.after.position_statistics.maximum + 2e-4);
  EXPECT_NE(both.files[0].text, of_errors.files[0].text);
  const TableReport report{request.machine, both, {}, {}};
  EXPECT_THAT(table_text(report), HasSubstr("workpiece: 11 um/(m K), right at 20 degC and now at 27 degC"));
  EXPECT_EQ(table_json(report)["workpiece"]["fixed_point_mm"][0], 200);
}

}  // namespace
}  // namespace abbe
