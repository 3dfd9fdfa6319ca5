#include "abbe/study/compensation/corrected_robot_program.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "abbe/compensate/compensated_inverse.h"
#include "abbe/errors/actual_pose.h"
#include "abbe/errors/error_states.h"
#include "abbe/formats/machine/correction_limits.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/number_text.h"
#include "abbe/geometry/rotation.h"
#include "abbe/machine/axis_unit.h"
#include "abbe/machine/coupling.h"
#include "abbe/machine/inverse_kinematics.h"
#include "abbe/machine/machine_check.h"
#include "abbe/machine/position_words.h"

namespace abbe {
namespace {

constexpr double kAtTravelEnd = 1e-9;  // mm or rad
/// rad; numbers of programs are rounded, and a joint at the end of a range of its configuration may be beyond it.
constexpr double kRangeRounding = 1e-3;
constexpr double kSingularArm = 1e-5;  // InverseSolution::singular_margin below which a pose has no certain commands

/// [axes] joint of the program that moves each axis: the number in the name of the axis.
std::vector<std::size_t> joints_of_axes(const RobotProgramRequest& request) {
  std::vector<std::size_t> joints;
  for (const Axis& axis : request.machine.axes) {
    std::size_t number = 0;
    for (const char c : axis.name.substr(1)) number = 10 * number + static_cast<std::size_t>(c - '0');
    const bool again = std::find(joints.begin(), joints.end(), number - 1) != joints.end();
    if (number == 0 || number > 9 || again) {
      throw InputError({.file = request.machine_file, .field = "axis." + axis.name},
                       again ? "another axis has the same number" : "the name says no joint of the program",
                       "names that end in the number of their joint: A1, A2, A3, ...");
    }
    joints.push_back(number - 1);
  }
  return joints;
}

InputError position_error(const RobotProgramRequest& request, const RobotPosition& position, const std::string& problem,
                          const std::string& expected) {
  return {{.file = request.program.file, .line = position.line, .field = position.name}, problem, expected};
}

/// Cartesian positions of one program are in one frame, which the machine file describes.
void check_frames(const RobotProgramRequest& request) {
  const RobotPosition* first = nullptr;
  for (const RobotPosition& position : request.program.positions) {
    if (position.kind != RobotPositionKind::pose) continue;
    if (request.program.language == RobotLanguage::krl && !position.frame.empty()) {
      throw position_error(request, position, "the program uses several tools or bases: " + position.frame,
                           "one, which the machine file describes");
    }
    if (first == nullptr) first = &position;
    if (position.frame != first->frame) {
      throw position_error(request, position,
                           fmt::format("is in {}, but {} is in {}", position.frame, first->name, first->frame),
                           "one user frame and one tool, which the machine file describes");
    }
  }
  if (first != nullptr && request.machine.axes.size() != 6) {
    throw position_error(
        request, *first,
        fmt::format("Cartesian positions determine six axes, and the machine has {}", request.machine.axes.size()),
        "joint positions, or a machine with six axes");
  }
}

std::vector<double> commands_of(const RobotProgramRequest& request, const std::vector<std::size_t>& joints,
                                const RobotPosition& position) {
  std::vector<double> commands;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const Axis& axis = request.machine.axes[i];
    const auto& number = position.joints[joints[i]];
    if (!number) {
      throw position_error(request, position,
                           fmt::format("has no value of joint {}, axis {}", joints[i] + 1, axis.name),
                           "a value for each axis of the machine");
    }
    const bool linear = axis.kind == AxisKind::linear;
    if (request.program.language == RobotLanguage::fanuc_ls && number->is_length != linear) {
      throw position_error(request, position,
                           fmt::format("joint {} has the wrong unit for axis {}", joints[i] + 1, axis.name),
                           linear ? "mm" : "deg");
    }
    const double command = number->value * robot_joint_unit(request.program.language, linear);
    if (!axis.endless && !(command >= axis.travel_min - kAtTravelEnd && command <= axis.travel_max + kAtTravelEnd)) {
      throw position_error(request, position,
                           fmt::format("joint {} is outside the travel of axis {}", joints[i] + 1, axis.name),
                           "a command within the travel in the machine file");
    }
    commands.push_back(command);
  }
  return commands;
}

/// Whether commands stand where the configuration of a position says.
bool fits_configuration(const RobotPosition& position, const std::vector<std::size_t>& joints,
                        const std::vector<double>& commands) {
  for (std::size_t i = 0; i < joints.size(); ++i) {
    if (joints[i] >= 6 || !position.configuration[joints[i]]) continue;
    const JointRange& range = *position.configuration[joints[i]];
    if (commands[i] < range.from - kRangeRounding || commands[i] > range.to + kRangeRounding) return false;
  }
  return true;
}

struct OneCorrection {
  CorrectionStatus status = CorrectionStatus::not_run;
  std::vector<double> commands;
  double position_left = 0, orientation_left = 0;
};

OneCorrection corrected_once(const CompensatedInverse& inverse, const std::vector<double>& nominal) {
  OneCorrection result;
  result.commands = nominal;
  std::vector<const double*> in;
  std::vector<double*> out;
  for (std::size_t i = 0; i < nominal.size(); ++i) {
    in.push_back(&nominal[i]);
    out.push_back(&result.commands[i]);
  }
  inverse.correct({in, 1}, {out, &result.status, &result.position_left, &result.orientation_left});
  return result;
}

class RobotCorrector {
 public:
  explicit RobotCorrector(const RobotProgramRequest& request)
      : request_(request),
        joints_(joints_of_axes(request)),
        actual_(request.machine, request.errors.errors,
                {.target = TargetKind::full_pose, .largest_turn = request.largest_turn}, request.held),
        nominal_(request.machine, {.held = {}, .reference = {}, .all_turns = true}) {}

  CorrectedRobotPosition correct(const RobotPosition& position, RobotValues& values) {
    CorrectedRobotPosition result;
    RigidTransform wanted;
    if (position.kind == RobotPositionKind::joints) {
      result.nominal = commands_of(request_, joints_, position);
      wanted = nominal_workpiece_from_tool(request_.machine, result.nominal);
    } else {
      wanted = robot_pose(request_.program, position);
      choose_branch(position, wanted, result);
    }
    if (!result.problem.empty()) {
      before_.clear();
      return result;
    }
    before_ = result.nominal;
    Deviation deviation;
    tool_deviation(request_.machine, request_.errors.errors, result.nominal, deviation);
    result.shift = deviation.head<3>().norm();
    const OneCorrection found = corrected_once(actual_, result.nominal);
    if (!reaches_point(found.status)) {
      result.problem = fmt::format("{}: {:.3g} um and {:.3g} urad would be left", correction_status_text(found.status),
                                   1e3 * found.position_left, 1e6 * found.orientation_left);
      result.position_left = found.position_left;
      result.orientation_left = found.orientation_left;
      return result;
    }
    // Other joints may cross an end of their range: the program then says so. This one is the status of the wrist.
    const auto is_negative = [&](const std::vector<double>& commands, std::size_t i) {
      return commands[i] + coupled_part(request_.machine, i, commands.data()) < 0;
    };
    for (std::size_t i = 0; i < joints_.size(); ++i) {
      if (joints_[i] != 4 || is_negative(found.commands, i) == is_negative(result.nominal, i) ||
          position.configuration[4] == std::nullopt)
        continue;
      result.problem = "the correction turns the wrist over: joint 5 passes zero";
      return result;
    }
    result.corrected = found.commands;
    write(position, wanted, result, values);
    return result;
  }

  /// [6] joints of the arm at commands of the axes. Cartesian positions have six axes.
  std::vector<double> arm_of(const std::vector<double>& commands) const {
    std::vector<double> arm(6, 0.0);
    for (std::size_t i = 0; i < joints_.size(); ++i) {
      if (joints_[i] < arm.size()) arm[joints_[i]] = commands[i];
    }
    return arm;
  }

 private:
  /// The commands that the control takes for a pose: those with its configuration, of several the nearest to the
  /// position before.
  void choose_branch(const RobotPosition& position, const RigidTransform& wanted,
                     CorrectedRobotPosition& result) const {
    const InverseResult branches = nominal_.solve(PoseTarget::at(wanted), start_for(position));
    std::vector<std::vector<double>> fitting;
    for (const InverseSolution& solution : branches.solutions) {
      if (!solution.within_travel) continue;
      if (solution.singularity != PoseSingularity::none || solution.singular_margin < kSingularArm) {
        result.problem = "singular: infinitely many axis positions have this pose";
        return;
      }
      std::vector<double> commands(solution.position.begin(),
                                   solution.position.begin() + static_cast<std::ptrdiff_t>(joints_.size()));
      if (fits_configuration(position, joints_, commands)) fitting.push_back(std::move(commands));
    }
    if (fitting.empty()) {
      result.problem = branches.status == InverseStatus::solved
                           ? "no axis positions with this pose have the configuration that the position states"
                       : branches.status == InverseStatus::outside_travel
                           ? "no axis positions within the travels have this pose"
                           : describe(request_.machine, branches);
      return;
    }
    if (fitting.size() > 1 && before_.empty()) {
      result.problem = fmt::format(
          "{} sets of axis positions have this pose, and no position before it says which one is "
          "near: put a joint position before it, or narrow the travels in the machine file",
          fitting.size());
      return;
    }
    result.is_nearest = fitting.size() > 1;
    const auto distance = [&](const std::vector<double>& commands) {
      double square = 0;
      for (std::size_t i = 0; i < commands.size() && !before_.empty(); ++i) {
        const double scale = request_.machine.axes[i].kind == AxisKind::linear ? 1e-3 : 1;
        square += std::pow(scale * (commands[i] - before_[i]), 2);
      }
      return square;
    };
    result.nominal = *std::min_element(fitting.begin(), fitting.end(),
                                       [&](const auto& a, const auto& b) { return distance(a) < distance(b); });
  }

  /// Where the search of branches starts: endless axes are found on the turn that is nearest to it.
  std::vector<double> start_for(const RobotPosition& position) const {
    std::vector<double> start = before_;
    start.resize(joints_.size(), 0.0);
    for (std::size_t i = 0; i < joints_.size(); ++i) {
      if (joints_[i] >= 6 || !request_.machine.axes[i].endless || !position.configuration[joints_[i]]) continue;
      const JointRange& range = *position.configuration[joints_[i]];
      start[i] = std::midpoint(range.from, range.to);
    }
    return start;
  }

  /// The numbers of the corrected position as they are written, and what these leave.
  void write(const RobotPosition& position, const RigidTransform& wanted, CorrectedRobotPosition& result,
             RobotValues& values) const {
    const RobotLanguage language = request_.program.language;
    std::vector<double> reached = result.corrected;
    RobotPosition written = position;
    const auto as_written = [&](std::size_t i, double value) {
      double number = value;
      parse_number(robot_number_text(language, position, i, value), 0, number);
      return number;
    };
    if (position.kind == RobotPositionKind::joints) {
      values.assign(kRobotJoints, 0.0);
      for (std::size_t i = 0; i < kRobotJoints; ++i) values[i] = position.joints[i] ? position.joints[i]->value : 0;
      for (std::size_t i = 0; i < joints_.size(); ++i) {
        const double unit = robot_joint_unit(language, request_.machine.axes[i].kind == AxisKind::linear);
        double& value = values[joints_[i]];
        // An axis that keeps its command keeps its number.
        if (result.corrected[i] == result.nominal[i]) continue;
        value = result.corrected[i] / unit;
        reached[i] = as_written(joints_[i], value) * unit;
      }
    } else {
      values = robot_pose_numbers(language, position, nominal_workpiece_from_tool(request_.machine, result.corrected));
      for (std::size_t i = 0; i < values.size(); ++i) written.pose[i].value = as_written(i, values[i]);
      const InverseResult there =
          nominal_.solve(PoseTarget::at(robot_pose(request_.program, written)), result.corrected);
      if (there.status == InverseStatus::solved) {
        const auto& commands = there.solutions.front().position;
        reached.assign(commands.begin(), commands.begin() + static_cast<std::ptrdiff_t>(joints_.size()));
      }
    }
    const RigidTransform actual = actual_workpiece_from_tool(request_.machine, request_.errors.errors, reached);
    result.position_left = (actual.translation - wanted.translation).norm();
    result.orientation_left = rotation_vector(actual.rotation * wanted.rotation.transpose()).norm();
  }

  const RobotProgramRequest& request_;
  std::vector<std::size_t> joints_;
  CompensatedInverse actual_;
  InverseKinematics nominal_;
  std::vector<double> before_;  ///< commands of the position before; empty: not known
};

}  // namespace

CorrectedRobotProgram correct_robot_program(const RobotProgramRequest& request) {
  const double limit_um = refusal_limit("--limit-um", request.limit_um, "um");
  check_largest_turn(request.largest_turn);
  if (request.leave_out_factor != 0) {
    throw InputError({.field = "--leave-out-below-uncertainty"}, "nothing is left out of a robot program",
                     "this option only with commands in a CSV file");
  }
  const std::vector<MachineProblem> problems = find_problems(request.machine);
  if (!problems.empty()) throw InputError({.file = request.machine_file}, problems.front().text());
  check_frames(request);
  PoseList no_states;
  no_states.append(std::vector<double>(request.machine.axes.size(), 0.0));
  const std::size_t missing = missing_state(request.machine, request.errors.errors, no_states);
  if (missing != kNoState) {
    throw InputError({.field = "state." + request.machine.states[missing].name},
                     "the errors depend on this measured state, which a robot program does not give",
                     "--state " + state_column(request.machine.states[missing]) + "=VALUE");
  }
  RobotCorrector corrector(request);
  CorrectedRobotProgram result;
  result.left = request.program.left;
  result.has_reversals = !request.errors.errors.reversals.empty();
  std::vector<RobotValues> values(request.program.positions.size());
  std::vector<std::vector<double>> arms(values.size());
  std::size_t uncorrected = 0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    const RobotPosition& position = request.program.positions[k];
    result.positions.push_back(corrector.correct(position, values[k]));
    const CorrectedRobotPosition& corrected = result.positions.back();
    if (corrected.corrected != corrected.nominal && !corrected.corrected.empty())
      arms[k] = corrector.arm_of(corrected.corrected);
    if (!corrected.problem.empty() && uncorrected++ == 0)
      result.refused = fmt::format("line {}, {}: {}", position.line, position.name, corrected.problem);
    if (result.refused.empty() && !(1e3 * corrected.shift <= limit_um))
      result.refused = fmt::format("line {}, {}: correction of {:.3f} um above --limit-um {:g}", position.line,
                                   position.name, 1e3 * corrected.shift, limit_um);
  }
  if (uncorrected > 1) result.refused += fmt::format("; {} other positions are not corrected either", uncorrected - 1);
  if (result.refused.empty()) result.text = replaced_robot_text(request.program, values, arms);
  return result;
}

}  // namespace abbe
