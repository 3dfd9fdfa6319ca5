// Jobs at one temperature of a workpiece: programs and maps. Tables: workpiece_table_test.cpp of controls.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "abbe/errors/actual_pose.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/text/message_of.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/study/compensation/corrected_program.h"
#include "abbe/study/compensation/errors_map.h"

namespace abbe {
namespace {

using testing::HasSubstr;

const std::string kExamplesOfWarmParts = ABBE_SOURCE_DIR "/examples/";
constexpr double kLongerTool = 60;

const WorkpieceExpansion kWarmPart{.temperature = 28,
                                   .coefficient = 23.4e-6,
                                   .standard_uncertainty = 1e-6,
                                   .temperature_uncertainty = 0.4,
                                   .fixed_point = {30, -20, 10}};
constexpr double kStrainOfWarmPart = 23.4e-6 * 8;

Machine warm_trunnion() { return read_machine(kExamplesOfWarmParts + "machines/trunnion-mill.machine.toml"); }

ProgramRequest program_for_warm_part(const ErrorSet& errors) {
  ProgramRequest request;
  request.machine = warm_trunnion();
  request.errors = errors;
  request.program_file = "p.ngc";
  request.workpiece = kWarmPart;
  request.words = word_axes_by_name(request.machine);
  for (std::size_t word = 0; word < kAxisWords; ++word) {
    request.text.words[word] = request.words.axis[word] != Machine::npos;
  }
  return request;
}

/// Values of the axis words that stand last in a program.
std::map<char, double> last_words(const std::string& program) {
  std::map<char, double> words;
  std::istringstream lines(program);
  for (std::string line; std::getline(lines, line);) {
    if (line.find("G43") != std::string::npos) continue;
    for (std::size_t i = 0; i < line.size(); ++i) {
      if (std::string("XYZAC").find(line[i]) != std::string::npos) words[line[i]] = std::stod(line.substr(i + 1));
    }
  }
  return words;
}

std::vector<double> axes_of_words(const Machine& machine, const std::map<char, double>& words, double tool_length) {
  std::vector<double> at(machine.axes.size(), 0.0);
  for (const auto& [word, value] : words) {
    const std::size_t axis = machine.find_axis(std::string(1, word));
    at[axis] = machine.axes[axis].kind == AxisKind::rotary ? value * kDegree : value;
    if (word == 'Z') at[axis] += tool_length;
  }
  return at;
}

std::string run_warm_program(const ProgramRequest& request, const std::string& program, CorrectedProgram& result) {
  std::string text;
  result = correct_program(
      request, program, [&](std::string_view piece) { text += piece; }, [](std::size_t) {});
  EXPECT_TRUE(result.refused.empty()) << testing::PrintToString(result.refused);
  return text;
}

/// One move to a pose with a tool of that length.
std::string move_with_tool(double tool_length) {
  return "G21 G90\nG43.1 Z" + std::to_string(tool_length) +
         "\nG0 X0 Y0 Z-150 A0 C0\nG1 X60 Y-45 Z-180 A-25 C40 F600\nM2\n";
}

/// Where the actual tool is at the end of the program, from where it should be on the warm part.
double missed_on_warm_part(const ErrorSet& errors, double tool_length, const std::string& corrected) {
  Machine machine = warm_trunnion();
  machine.tool_offset -= Eigen::Vector3d(0, 0, tool_length);
  const std::vector<double> commanded =
      axes_of_words(machine, {{'X', 60}, {'Y', -45}, {'Z', -180}, {'A', -25}, {'C', 40}}, tool_length);
  const Eigen::Vector3d nominal = nominal_workpiece_from_tool(machine, commanded).translation;
  const Eigen::Vector3d wanted = kWarmPart.fixed_point + (1 + kStrainOfWarmPart) * (nominal - kWarmPart.fixed_point);
  const std::vector<double> at = axes_of_words(machine, last_words(corrected), tool_length);
  return (actual_workpiece_from_tool(machine, errors, at).translation - wanted).norm();
}

TEST(WorkpieceOfAProgram, TheToolReachesThePointsOfTheWarmPart) {
  const ErrorSet errors = read_errors(kExamplesOfWarmParts + "compensate/trunnion.errors.toml", warm_trunnion()).errors;
  for (const double tool_length : {0.0, kLongerTool}) {
    CorrectedProgram result;
    const std::string alone = run_warm_program(program_for_warm_part({}), move_with_tool(tool_length), result);
    EXPECT_LT(missed_on_warm_part({}, tool_length, alone), 3e-6) << "the decimals of the program";
    EXPECT_GT(missed_on_warm_part({}, tool_length, move_with_tool(tool_length)), 5e-3);
    const std::string with_errors =
        run_warm_program(program_for_warm_part(errors), move_with_tool(tool_length), result);
    // Second order: angles of 1e-4 act on the displacement of 20 um by the part.
    EXPECT_LT(missed_on_warm_part(errors, tool_length, with_errors), 2e-5);
  }
}

TEST(WorkpieceOfAProgram, ItsUncertaintyIsStated) {
  CorrectedProgram result;
  run_warm_program(program_for_warm_part({}), move_with_tool(kLongerTool), result);
  Machine machine = warm_trunnion();
  machine.tool_offset -= Eigen::Vector3d(0, 0, kLongerTool);
  const ProgramPlace& place = result.report.largest_shift;
  const std::vector<double> at(place.position.begin(),
                               place.position.begin() + static_cast<std::ptrdiff_t>(machine.axes.size()));
  const Eigen::Vector3d arm = nominal_workpiece_from_tool(machine, at).translation - kWarmPart.fixed_point;
  ASSERT_TRUE(result.largest.stated);
  EXPECT_NEAR(result.report.largest_shift.value, kStrainOfWarmPart * arm.norm(), 1e-3 * kStrainOfWarmPart * arm.norm());
  EXPECT_NEAR(result.largest.point / (std::sqrt(strain_variance(kWarmPart, 8)) * arm.norm()), 1, 2e-3);
  const ProgramWordsRequest words{.program = "p.ngc", .output = "out.ngc"};
  EXPECT_THAT(program_text(words, machine, result),
              HasSubstr("workpiece: 23.4 um/(m K), right at 20 degC and now at 28 degC, fixed at (30, -20, 10) mm\n"));
  EXPECT_EQ(program_json(words, machine, result)["workpiece"]["temperatures_degC"][0], 28);
}

TEST(WorkpieceOfAProgram, NeedsATemperatureAndErrorsAsInTheStandard) {
  ProgramRequest request = program_for_warm_part({});
  request.workpiece->temperature.reset();
  CorrectedProgram result;
  EXPECT_THAT(message_of([&] { run_warm_program(request, move_with_tool(0), result); }),
              HasSubstr("--workpiece-temperature-degC: is missing"));
  request = program_for_warm_part({});
  request.errors.composition.first_order = true;
  EXPECT_THAT(message_of([&] { run_warm_program(request, move_with_tool(0), result); }), HasSubstr("composition"));
}

TEST(WorkpieceOfAMap, IsADisplacementFromTheFixedPointWithItsUncertainty) {
  ErrorsMapRequest request;
  request.machine = warm_trunnion();
  request.workpiece = kWarmPart;
  request.fit_datum = false;
  request.grid.resize(request.machine.axes.size());
  for (std::size_t axis = 0; axis < request.grid.size(); ++axis) request.grid[axis] = AxisRange::fixed(0);
  request.grid[request.machine.find_axis("X")] = AxisRange{-50, 150, 5, 0};
  request.grid[request.machine.find_axis("A")] = AxisRange{-0.5, 0.5, 3, 0};
  const ErrorsMap map = map_errors(request);
  ASSERT_EQ(map.before.statistics.count, 15U);
  ASSERT_EQ(map.before.norm_uncertainty.size(), 15U);
  for (std::size_t k = 0; k < 15; ++k) {
    const std::vector<double> at = map.stated.poses.pose(k);
    const double arm = (nominal_workpiece_from_tool(request.machine, at).translation - kWarmPart.fixed_point).norm();
    EXPECT_NEAR(map.before.norm_uncertainty[k], std::sqrt(strain_variance(kWarmPart, 8)) * arm, 1e-3 * arm * 1e-5);
  }
  EXPECT_THAT(errors_map_text(map), HasSubstr("workpiece: 23.4 um/(m K)"));
  EXPECT_EQ(errors_map_json(map)["workpiece"]["coefficient_um_per_m_K"], 1e6 * 23.4e-6);
  // A best fit of the datum cannot take an expansion away: it has no part along a translation or a rotation of its own.
  request.fit_datum = true;
  EXPECT_GT(map_errors(request).before.statistics.maximum, 1e-2);
  // What is corrected for is the machine; the part stays.
  request.minus = request.errors;
  EXPECT_EQ(map_errors(request).after->statistics.maximum, map_errors(request).before.statistics.maximum);
}

}  // namespace
}  // namespace abbe
