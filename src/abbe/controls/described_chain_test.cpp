// The description that is written, evaluated by 4 x 4 matrices row by row, is the machine with its errors.
#include "abbe/controls/described_chain.h"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cmath>
#include <map>
#include <sstream>

#include "abbe/controls/control_table.h"
#include "abbe/controls/described_machines_for_test.h"
#include "abbe/errors/actual_pose.h"
#include "abbe/errors/poses.h"
#include "abbe/geometry/angle_units.h"

namespace abbe {
namespace {

using testing::HasSubstr;

constexpr double kTurnDeg = 180 / 3.14159265358979323846;

/// Numbers of a *.COM file as a person reads them: [column][row].
struct ReadTable {
  std::map<std::string, std::vector<double>> columns;

  explicit ReadTable(const std::string& text) {
    std::istringstream lines(text);
    std::string line, word;
    std::getline(lines, line);
    std::getline(lines, line);
    std::vector<std::string> names;
    for (std::istringstream words(line); words >> word;) names.push_back(word);
    while (std::getline(lines, line) && line != "[END]") {
      std::istringstream words(line);
      for (const std::string& name : names) {
        words >> word;
        columns[name].push_back(std::stod(word));
      }
    }
  }
  double at(const std::string& name, double position, bool endless) const {
    if (!columns.contains(name)) return 0;
    const std::vector<double>&x = columns.at("AXISPOS"), &y = columns.at(name);
    if (endless) position -= 360 * std::floor(position / 360);
    std::size_t k = 0;
    while (k + 2 < x.size() && x[k + 1] < position) ++k;
    return y[k] + (y[k + 1] - y[k]) * (position - x[k]) / (x[k + 1] - x[k]);
  }
};

class WrittenSet {
 public:
  WrittenSet(const Machine& machine, const ControlTables& made) : machine_(machine) {
    for (const ControlFile& file : made.files) {
      if (file.name == "KINEMATICS.TAB") description_ = file.text;
      if (file.name.size() == 5) tables_.emplace(file.name[0], ReadTable(file.text));
    }
  }

  /// Axis numbers of the control: in the order X Y Z A B C of the letters that there are.
  char letter_of(int number) const {
    for (const char letter : std::string("XYZABC")) {
      if (has(letter) && --number == 0) return letter;
    }
    ADD_FAILURE() << number;
    return 'X';
  }
  bool has(char letter) const { return machine_.find_axis(std::string(1, letter)) != Machine::npos; }
  const Axis& axis(char letter) const { return machine_.axes[machine_.find_axis(std::string(1, letter))]; }

  double command(char letter, const std::vector<double>& pose) const {
    return pose[machine_.find_axis(std::string(1, letter))] * (axis(letter).kind == AxisKind::rotary ? kTurnDeg : 1);
  }
  double column(char letter, const std::string& name, const std::vector<double>& pose) const {
    if (!tables_.contains(letter)) return 0;
    return tables_.at(letter).at(name, command(letter, pose), axis(letter).endless);
  }
  /// What the own columns add, mm or rad; they hold errors.
  std::vector<double> moved_by_own(std::vector<double> pose) const {
    const std::vector<double> asked = pose;
    int number = 0;
    for (const char letter : std::string("XYZABC")) {
      if (!has(letter)) continue;
      const double error = column(letter, std::to_string(++number), asked);
      const bool rotary = axis(letter).kind == AxisKind::rotary;
      pose[machine_.find_axis(std::string(1, letter))] -= rotary ? error / kTurnDeg : error;
    }
    return pose;
  }

  /// Table frame in the frame of the tool, row by row. @param with_comptab  false, all at zero: the workpiece's frame
  Eigen::Affine3d table_frame(const std::vector<double>& pose, bool with_comptab) const {
    Eigen::Affine3d frame = Eigen::Affine3d::Identity();
    std::istringstream lines(description_);
    std::string line;
    std::getline(lines, line);
    std::getline(lines, line);
    while (std::getline(lines, line) && line != "[END]") {
      line.resize(74, ' ');
      const auto field = [&](std::size_t from, std::size_t count) {
        const std::string text = line.substr(from, count);
        const std::size_t end = text.find_last_not_of(' ');
        return end == std::string::npos ? std::string() : text.substr(0, end + 1);
      };
      const std::string key = field(21, 10), coord = field(37, 20), comptab = field(57, 17);
      if (key == "MachBase") continue;
      const char letter = line[31];
      double value = key == "MachAxis" ? -command(letter, pose) : coord.empty() ? 0 : std::stod(coord);
      if (with_comptab && !comptab.empty() && comptab[0] != 'A') value += std::stod(comptab);
      if (with_comptab && !comptab.empty() && comptab[0] == 'A') {
        value += column(letter_of(comptab[1] - '0'), comptab.substr(2), pose);
      }
      const std::size_t c = std::string("XYZABC").find(letter);
      const Eigen::Vector3d unit = Eigen::Vector3d::Unit(static_cast<Eigen::Index>(c % 3));
      if (c < 3) {
        frame = frame * Eigen::Translation3d(value * unit);
      } else {
        frame = frame * Eigen::AngleAxisd(value / kTurnDeg, unit);
      }
    }
    return frame;
  }
  const std::string& description() const { return description_; }

 private:
  const Machine& machine_;
  std::string description_;
  std::map<char, ReadTable> tables_;
};

class DescribedChain : public testing::TestWithParam<test::DescribedCase> {};

TEST_P(DescribedChain, OfTheWrittenSetIsTheMachineWithAllItsErrors) {
  const Machine machine = GetParam().machine();
  const ErrorSet errors = test::all_errors(machine);
  ControlTableRequest request = test::comp_request(machine, errors);
  request.tolerance_mm = 2e-5;
  request.tolerance_rad = 5e-8;
  const ControlTables made = make_control_tables(request);
  ASSERT_FALSE(made.says_no()) << made.refused.size() << made.too_few_nodes;
  const WrittenSet set(machine, made);
  const std::vector<double> zero(machine.axes.size(), 0.0);
  const Eigen::Affine3d at_zero = set.table_frame(zero, false);
  double largest = 0, turn = 0, before = 0;
  for (const std::vector<double>& pose : test::poses_within(machine, 40)) {
    // workpiece frame = table frame as it is placed at zero.
    const Eigen::Affine3d tool = Eigen::Translation3d(machine.tool_reference) * at_zero *
                                 set.table_frame(pose, true).inverse() * Eigen::Translation3d(machine.tool_offset);
    const RigidTransform actual = actual_workpiece_from_tool(machine, errors, set.moved_by_own(pose));
    const RigidTransform nominal = nominal_workpiece_from_tool(machine, pose);
    const RigidTransform placed = machine.bed_from_workpiece;
    const Eigen::Vector3d seen = placed.inverse() * Eigen::Vector3d(tool.translation());
    largest = std::max(largest, (seen - actual.translation).norm());
    before = std::max(before, (nominal.translation - actual.translation).norm());
    turn = std::max(turn, (placed.rotation.transpose() * tool.linear() - actual.rotation).norm());
  }
  EXPECT_GT(before, 0.02) << "errors that are worth it";
  EXPECT_LT(largest, 3e-4);
  EXPECT_LT(turn, 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Machines, DescribedChain, testing::ValuesIn(test::described_cases()),
                         [](const auto& each) { return each.param.name; });

TEST(DescribedAxes, WithoutErrorsAreTheTableOfTheManual) {
  const Machine machine = test::machine_of_the_manual();
  const std::vector<DescribedAxis> axes = described_axes(machine, {}, "x");
  std::string letters;
  for (const DescribedAxis& axis : axes) letters += axis.letter;
  EXPECT_EQ(letters, "BYXZC");  // page 670
  EXPECT_LT((axes[0].shift - Eigen::Vector3d(0.016, 0, 250.051)).norm(), 1e-12);
  EXPECT_LT((axes[4].shift - Eigen::Vector3d(-298.923, 200.172, 0)).norm(), 1e-12);
  for (const DescribedAxis& axis : axes) {
    EXPECT_EQ(std::abs(axis.tilt[0]) + std::abs(axis.tilt[1]), 0) << axis.letter;
  }
}

}  // namespace
}  // namespace abbe
