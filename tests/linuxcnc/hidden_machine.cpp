#include "hidden_machine.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <random>

#include "abbe/compensate/one_pose_for_test.h"
#include "abbe/errors/actual_pose.h"
#include "abbe/errors/random_errors.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/machine/inverse_kinematics.h"
#include "abbe/runtime/freeze.h"
#include "judging.h"

namespace abbe {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kPartUncertain = 0.02;  // standard uncertainty of an identified parameter, of itself

CorrectionOptions tight() {
  CorrectionOptions options;
  options.position_tolerance = 5e-11;
  options.orientation_tolerance = 1e-13;
  return options;
}

}  // namespace

HiddenMachine::HiddenMachine(const Wiring& given)
    : wiring(given),
      machine(read_machine(ABBE_SOURCE_DIR "/examples/machines/" + given.machine + ".machine.toml")),
      tool_offset(-machine.tool_offset) {
  RandomErrorOptions options;
  options.seed = 77;
  truth = random_errors(machine, options);
  scale_errors(machine, truth, {.measure = VolumetricMeasure::mean, .value_um = 100, .remove_rigid_motion = false});
  std::mt19937_64 generator(5);
  identified = nearly(truth, kPartUncertain, generator);
  const std::vector<double> values = truth.parameters();
  covariance =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(values.size()), static_cast<Eigen::Index>(values.size()));
  for (std::size_t p = 0; p < values.size(); ++p) {
    const auto i = static_cast<Eigen::Index>(p);
    covariance(i, i) = std::pow(kPartUncertain * values[p], 2);
  }
  machine.tool_offset.setZero();
  for (const std::string& name : wiring.joints) axis_of_joint.push_back(machine.find_axis(name));
  if (wiring.joints.size() != machine.axes.size() || wiring.words.size() != machine.axes.size() ||
      std::find(axis_of_joint.begin(), axis_of_joint.end(), Machine::npos) != axis_of_joint.end())
    fail("joints and words are not those of " + wiring.machine);
  if (wiring.tool_space)
    world_zero = nominal_workpiece_from_tool(machine, std::vector<double>(count(), 0.0)).translation;
}

bool HiddenMachine::is_rotary(std::size_t joint) const {
  return machine.axes[axis_of_joint[joint]].kind == AxisKind::rotary;
}

double HiddenMachine::unit(std::size_t joint) const { return is_rotary(joint) ? kDegree : 1; }

std::vector<double> HiddenMachine::commands_of(const double* joints) const {
  std::vector<double> commands(count());
  for (std::size_t j = 0; j < count(); ++j) commands[axis_of_joint[j]] = joints[j] * unit(j);
  return commands;
}

Machine HiddenMachine::with_tool(const Eigen::Vector3d& offset) const {
  Machine other = machine;
  other.tool_offset = -offset;
  return other;
}

std::vector<double> HiddenMachine::world_of(const std::vector<double>& commands, const Eigen::Vector3d& offset) const {
  const Eigen::Vector3d point =
      nominal_workpiece_from_tool(with_tool(offset), commands).translation - world_zero + offset;
  std::vector<double> world;
  for (std::size_t j = 0; j < count(); ++j) {
    const bool of_point = wiring.tool_space && wiring.words[j] >= 'X';
    world.push_back(of_point ? point[wiring.words[j] - 'X'] : commands[axis_of_joint[j]] / unit(j));
  }
  return world;
}

Library::Library(const HiddenMachine& hidden, const Eigen::Vector3d& offset, const ErrorSet& errors)
    : hidden_(hidden), offset_(offset), machine_(hidden.with_tool(offset)), inverse_(machine_, errors, tight()) {}

std::vector<double> Library::nominal(const double* world) const {
  if (!hidden_.wiring.tool_space) return hidden_.commands_of(world);
  InverseOptions options;
  Eigen::Vector3d point = hidden_.world_zero - offset_;
  for (std::size_t j = 0; j < hidden_.count(); ++j) {
    if (hidden_.wiring.words[j] >= 'X') {
      point[hidden_.wiring.words[j] - 'X'] += world[j];
    } else {
      options.held.push_back({hidden_.axis_of_joint[j], world[j] * hidden_.unit(j)});
    }
  }
  const InverseResult found = InverseKinematics(machine_, options).solve(PoseTarget::at(point));
  if (found.solutions.empty()) return {};
  const auto& position = found.solutions[0].position;
  return {position.begin(), position.begin() + static_cast<std::ptrdiff_t>(hidden_.count())};
}

std::vector<double> Library::compensated(const std::vector<double>& nominal, CorrectionStatus& status) const {
  return test::corrected(inverse_, nominal, status);
}

Eigen::Matrix3d Library::point_covariance(const std::vector<double>& nominal) const {
  Deviation deviation;
  Eigen::MatrixXd by_parameters;
  tool_deviation(machine_, hidden_.identified, nominal, deviation, &by_parameters);
  const Eigen::MatrixXd point = by_parameters.topRows<3>();
  return point * hidden_.covariance * point.transpose();
}

double Library::error(const ErrorSet& actual, const std::vector<double>& commands,
                      const std::vector<double>& nominal) const {
  return (actual_workpiece_from_tool(machine_, actual, commands).translation -
          nominal_workpiece_from_tool(machine_, nominal).translation)
      .norm();
}

double write_frozen(const HiddenMachine& hidden, const std::string& path, bool uncertain) {
  FreezeOptions options;
  options.poses = 200;
  options.version = "test";
  if (uncertain) options.covariance = hidden.covariance;
  // A focus may lie on the other side of the gauge point.
  options.tool_length_min = std::min(0.0, hidden.tool_offset.dot(hidden.machine.tool_direction));
  const FrozenCompensation frozen = freeze(hidden.machine, hidden.identified, options);
  if (!frozen.problem.empty()) fail(frozen.problem);
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(frozen.bytes.data()), static_cast<std::streamsize>(frozen.bytes.size()));
  file.close();
  if (!file) fail("cannot write " + path);
  return frozen.uncertainty_lattice;
}

}  // namespace abbe
