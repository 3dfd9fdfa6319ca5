#include "abbe/compensate/compensated_inverse.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "abbe/compensate/program/chord_steps.h"
#include "abbe/compensate/program/correction_step.h"
#include "abbe/errors/error_states.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/machine/inverse_kinematics.h"
#include "abbe/machine/machine_check.h"

namespace abbe {
namespace {

constexpr std::size_t kBlock = kCorrectionBlock;
constexpr int kRefresh = 6;     // iterations after which the derivative is taken anew
constexpr int kChordSteps = 6;  // with the derivative of the nominal machine, before the actual one is taken
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

using Block = CorrectionBlock;
using Lanes = CorrectionBlock::Lanes;

PointArrays pointers(std::array<Lanes, 3>& lanes) { return {lanes[0].data(), lanes[1].data(), lanes[2].data()}; }

using AxisPointers = std::array<const double*, kMaxAxes>;
AxisPointers pointers(const std::array<Lanes, kMaxAxes>& lanes) {
  AxisPointers axes;
  for (std::size_t i = 0; i < kMaxAxes; ++i) axes[i] = lanes[i].data();
  return axes;
}

/// rad; turns of axes within it cost no digit that matters, beyond it whole turns are set aside.
constexpr double kFewTurns = 100;

/// True where the machine is the same after each turn of an axis.
bool repeats_each_turn(const Machine& machine, std::size_t i, const ErrorSet& errors) {
  if (!machine.axes[i].endless) return false;
  const std::vector<std::uint8_t> used = used_states(machine, errors);
  for (std::size_t j = 0; j < used.size(); ++j) {
    if (used[j] != 0 && machine.states[j].kind == StateKind::axis && machine.states[j].axis == i) return false;
  }
  return std::all_of(errors.motions.begin(), errors.motions.end(), [&](const ErrorMotion& motion) {
    if (motion.axis != i) return true;
    const double periods = motion.basis.period > 0 ? kTurn / motion.basis.period : 0;
    return motion.basis.covers(motion.basis.to + kTurn) && periods > 0.5 &&
           std::abs(periods - std::round(periods)) <= 1e-15 * periods;
  });
}

RotationArrays pointers(std::array<Lanes, 9>& lanes) {
  RotationArrays rotation;
  for (std::size_t i = 0; i < 9; ++i) rotation.r[i] = lanes[i].data();
  return rotation;
}

}  // namespace

const char* correction_status_text(CorrectionStatus status) {
  switch (status) {
    case CorrectionStatus::not_run:
      return "not run";
    case CorrectionStatus::reached:
      return "reached";
    case CorrectionStatus::orientation_left:
      return "orientation left";
    case CorrectionStatus::turn_limited:
      return "turn limited";
    case CorrectionStatus::position_left:
      return "position left";
    case CorrectionStatus::outside_travel:
      return "outside travel";
    case CorrectionStatus::not_covered:
      return "not covered";
    case CorrectionStatus::not_converged:
      return "not converged";
    case CorrectionStatus::not_finite:
      return "not finite";
  }
  return "";
}

struct CompensatedInverse::Implementation {
  Implementation(const Machine& given, const ErrorSet& errors, const CorrectionOptions& wanted,
                 std::span<const std::size_t> held)
      : machine(given), options(wanted) {
    const std::vector<MachineProblem> problems = find_problems(machine);
    if (!problems.empty()) {
      problem = problems.front().text();
      return;
    }
    std::vector<HeldAxis> kept;
    for (const std::size_t axis : held) {
      if (axis >= machine.axes.size()) {
        problem = "an axis to be held does not exist";
        return;
      }
      kept.push_back({axis, 0});
    }
    problem = problem_of_kept(kept);
    if (!problem.empty()) return;
    for (std::size_t i = 0; i < machine.axes.size(); ++i) repeats[i] = repeats_each_turn(machine, i, errors);
    stepper = std::make_unique<CorrectionStep>(machine, options, kept);
    if (stepper->is_inverted()) {
      Machine keeping = machine;  // setting axes are the first to be held, at their command of the start
      for (const HeldAxis& axis : kept) keeping.axes[axis.axis].setting = true;
      branches = std::make_unique<InverseKinematics>(keeping);
    }
    if (stepper->is_straight()) chords.emplace(machine, options, stepper->turning(), stepper->reaching());
    actual = std::make_unique<ChainPlan>(machine, errors, Body::tool, Body::workpiece);
    nominal = std::make_unique<ChainPlan>(machine, ErrorSet{}, Body::tool, Body::workpiece);
    for (int i = 0; i < 3; ++i) {
      if (machine.tool_direction == Eigen::Vector3d::Unit(i)) along = i;
    }
    for (std::size_t i = 0; i < 3; ++i) {
      const Eigen::Index e = static_cast<Eigen::Index>(i);
      nominal_tool[i].fill(machine.tool_offset[e]);
      actual_tool[i].fill(machine.tool_offset[e] + errors.tool_offset_error[e]);
    }
    zeros.fill(0);
    ones.fill(1);
  }

  /// An axis that keeps its command while one that it is coupled to moves would not stand still.
  std::string problem_of_kept(const std::vector<HeldAxis>& kept) const {
    const auto is_kept = [&](std::size_t axis) {
      return std::any_of(kept.begin(), kept.end(), [axis](const HeldAxis& held) { return held.axis == axis; });
    };
    for (const AxisCoupling& coupling : machine.couplings) {
      if (!is_kept(coupling.axis) || is_kept(coupling.of)) continue;
      const std::string &axis = machine.axes[coupling.axis].name, &of = machine.axes[coupling.of].name;
      return axis + " cannot be held alone: it is coupled to " + of + "; hold " + of + " too";
    }
    return {};
  }

  /// Where a machine has its tool at the positions of the block: its point, and its rotation or its direction.
  void pose(const ChainPlan& plan, Block& block, const std::array<Lanes, 3>& tool, std::array<Lanes, 3>& point,
            std::array<Lanes, 9>& rotation, std::array<Lanes, 3>& direction, std::uint8_t* covered) const {
    const AxisPointers axes = pointers(block.position);
    const PositionArrays positions{{axes.data(), machine.axes.size()}, block.count, block.given_states()};
    const ConstPointArrays start{tool[0].data(), tool[1].data(), tool[2].data()};
    RotationArrays columns = pointers(rotation);
    const bool is_column = options.target != TargetKind::full_pose && along >= 0;
    if (is_column) {
      columns = {};
      for (std::size_t i = 0; i < 3; ++i) columns.r[3 * i + static_cast<std::size_t>(along)] = direction[i].data();
    }
    plan.transform(positions, start, pointers(point), columns, covered);
    if (is_column) return;
    const Eigen::Vector3d& of_tool = machine.tool_direction;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t k = 0; k < block.count; ++k) {
        direction[i][k] =
            rotation[3 * i][k] * of_tool[0] + rotation[3 * i + 1][k] * of_tool[1] + rotation[3 * i + 2][k] * of_tool[2];
      }
    }
  }

  /// Where the tool is by now.
  void evaluate(Block& block) const {
    pose(*actual, block, actual_tool, block.point, block.rotation, block.direction, block.covered.data());
  }

  /// Derivatives of point and orientation by all commands, where the block stands.
  void differentiate(Block& block) const {
    const AxisPointers axes = pointers(block.position);
    const ConstPointArrays none{zeros.data(), zeros.data(), zeros.data()};
    const ConstPointArrays unit[3] = {{ones.data(), zeros.data(), zeros.data()},
                                      {zeros.data(), ones.data(), zeros.data()},
                                      {zeros.data(), zeros.data(), ones.data()}};
    std::array<RowArrays, kMostCorrectionRows> rows;
    for (std::size_t i = 0; i < 3; ++i) rows[i] = {unit[i], none};
    const std::size_t orientation_rows = stepper->orientation_rows();
    for (std::size_t i = 0; i < orientation_rows; ++i) {
      if (orientation_rows == 3) {
        rows[3 + i] = {none, unit[i]};
      } else {
        rows[3 + i] = {none, {block.across[i][0].data(), block.across[i][1].data(), block.across[i][2].data()}};
      }
    }
    const PointArrays seen = pointers(block.point);
    actual->differentiate({{axes.data(), machine.axes.size()}, block.count, block.given_states()},
                          {actual_tool[0].data(), actual_tool[1].data(), actual_tool[2].data()},
                          {seen.x, seen.y, seen.z}, {rows.data(), 3 + orientation_rows}, {}, nullptr, 0, nullptr,
                          block.by_command.data());
    for (std::size_t i = 0; block.any_at_end && i < machine.axes.size(); ++i) {
      for (std::size_t row = 0; row < 3 + orientation_rows; ++row) {
        for (std::size_t k = 0; k < block.count; ++k) {
          if (block.at_end[i][k] != 0) block.by_command[(i * (3 + orientation_rows) + row) * block.count + k] = 0;
        }
      }
    }
    stepper->take_derivative(block);
  }

  /// Commands kept within travel, there to stay; true if one had to be.
  bool keep_within_travel(Block& block, std::size_t k) const {
    bool kept = false;
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
      const Axis& axis = machine.axes[i];
      double& position = block.position[i][k];
      if (axis.endless || (position >= axis.travel_min && position <= axis.travel_max)) continue;
      position = std::clamp(position, axis.travel_min, axis.travel_max);
      if (!block.any_at_end) {
        block.any_at_end = true;
        for (auto& lanes : block.at_end) lanes.fill(0);
      }
      block.at_end[i][k] = 1;
      kept = true;
    }
    return kept;
  }

  void as_they_came(Block& block, std::size_t k) const {
    for (std::size_t i = 0; i < machine.axes.size(); ++i) block.position[i][k] = block.command[i][k];
  }

  static bool any_active(const Block& block) {
    return std::any_of(block.active.begin(), block.active.begin() + static_cast<std::ptrdiff_t>(block.count),
                       [](std::uint8_t active) { return active != 0; });
  }

  /// Steps of the poses that are active, which stand evaluated, until each has come to its end or there were too many.
  void iterate(Block& block) const {
    block.point_only = false;
    take_steps(block);
    if (!stepper->is_arm() || !any_active(block)) return;
    // Near a singularity the steps for the orientation may go to and fro.
    block.point_only = true;
    take_steps(block);
  }

  void take_steps(Block& block) const {
    const int refresh = stepper->is_arm() ? 1 : kRefresh;
    for (int i = 0; i < options.largest_iterations; ++i) {
      if (!any_active(block)) break;
      if (i % refresh == 0) differentiate(block);
      for (std::size_t k = 0; k < block.count; ++k) {
        if (block.active[k] != 0) stepper->step(block, k);
      }
      if (!any_active(block)) break;
      evaluate(block);
    }
  }

  /// Ends poses whose steps did not come to an end, so that no pose goes on because another one does.
  /// @param kept   [poses] an axis is at the end of its travel: no better place is known than the one they led to
  /// @param moved  becomes 1 where the residuals are no longer those of the commands
  void give_up(Block& block, const std::array<std::uint8_t, kBlock>& kept,
               std::array<std::uint8_t, kBlock>& moved) const {
    for (std::size_t k = 0; k < block.count; ++k) {
      if (block.active[k] == 0) continue;
      if (kept[k] != 0) {
        CorrectionStep::finish(block, k, CorrectionStatus::outside_travel);
        keep_within_travel(block, k);
      } else {
        CorrectionStep::finish(block, k, CorrectionStatus::not_converged);
        as_they_came(block, k);
      }
      moved[k] = 1;
    }
  }

  bool is_within_travel(const Block& block, std::size_t k) const {
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
      const Axis& axis = machine.axes[i];
      const double position = block.position[i][k];
      if (!axis.endless && !(position >= axis.travel_min && position <= axis.travel_max)) return false;
    }
    return true;
  }

  /// Finishes the poses that are reached by steps of whole blocks within the travels. All others stand as they came.
  void take_chords(Block& block) const {
    ChordBlock chord;
    chords->start(block, chord);
    const int most = std::min(kChordSteps, options.largest_iterations);
    for (int i = 0; i < most && chords->step(block, chord); ++i) {
      if (i + 1 < most) evaluate(block);
    }
    bool moved = false;
    for (std::size_t k = 0; k < block.count; ++k) {
      if (block.active[k] == 0) continue;
      if (chord.left[k] == 0 && is_within_travel(block, k)) {
        CorrectionStep::finish(block, k, CorrectionStatus::reached);
      } else {
        as_they_came(block, k);
        moved = true;
      }
    }
    if (moved) evaluate(block);
  }

  void solve(Block& block) const {
    evaluate(block);
    for (std::size_t k = 0; k < block.count; ++k) {
      if (block.active[k] == 0) continue;
      if (block.covered[k] == 0) {
        CorrectionStep::finish(block, k, CorrectionStatus::not_covered);
        block.position_residual[k] = block.orientation_residual[k] = kUnknown;
      }
    }
    if (chords) take_chords(block);
    if (!any_active(block)) return;
    stepper->find_across(block);
    std::array<std::uint8_t, kBlock> kept{}, moved{};
    iterate(block);
    give_up(block, kept, moved);
    // An axis at its end stays there, and the others take what they can of the rest: each round holds at least one
    // more.
    for (std::size_t round = 0; round <= machine.axes.size(); ++round) {
      bool again = false;
      for (std::size_t k = 0; k < block.count; ++k) {
        const CorrectionStatus status = block.status[k];
        const bool fixed = status == CorrectionStatus::not_covered || status == CorrectionStatus::not_converged ||
                           status == CorrectionStatus::not_finite;
        if (fixed || !keep_within_travel(block, k)) continue;
        kept[k] = block.active[k] = 1;
        again = true;
      }
      if (!again) break;
      evaluate(block);
      iterate(block);
      give_up(block, kept, moved);
    }
    bool again = false;
    for (std::size_t k = 0; k < block.count; ++k) {
      if (kept[k] != 0 && block.status[k] != CorrectionStatus::reached)
        block.status[k] = CorrectionStatus::outside_travel;
      again = again || moved[k] != 0;
    }
    if (!again) return;
    evaluate(block);
    for (std::size_t k = 0; k < block.count; ++k) {
      if (moved[k] != 0) stepper->state_residuals(block, k);
    }
  }

  /// What is solved for: after many turns the last digits of a command are larger than the tolerances. The remainder
  /// is exact, and the turn as a number of 64 bits is wrong by less than the last digit of a command.
  double in_turn(std::size_t axis, double command) const {
    return repeats[axis] && std::abs(command) > kFewTurns ? std::remainder(command, kTurn) : command;
  }

  /// Marks poses without numbers; their places are filled with harmless ones.
  void load(Block& block, PositionArrays commands, std::size_t first) const {
    block.any_at_end = false;
    block.states = commands.state.size();
    for (std::size_t j = 0; j < block.states; ++j) {
      block.state[j] = commands.state[j] == nullptr ? nullptr : commands.state[j] + first;
    }
    for (std::size_t k = 0; k < block.count; ++k) {
      block.status[k] = CorrectionStatus::not_run;
      block.active[k] = 1;
      block.position_residual[k] = block.orientation_residual[k] = kUnknown;
    }
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
      for (std::size_t k = 0; k < block.count; ++k) {
        const double value = in_turn(i, commands.axis[i][first + k]);
        block.command[i][k] = value;
        block.position[i][k] = std::isfinite(value) ? value : 0;
        if (!std::isfinite(value)) CorrectionStep::finish(block, k, CorrectionStatus::not_finite);
      }
    }
  }

  /// @param commands  may be the arrays that are written
  void store(const Block& block, PositionArrays commands, const CorrectedArrays& corrected, std::size_t first) const {
    for (std::size_t k = 0; k < block.count; ++k) {
      const bool as_came = block.status[k] == CorrectionStatus::not_finite;
      for (std::size_t i = 0; i < machine.axes.size(); ++i) {
        const double command = commands.axis[i][first + k];
        double& out = corrected.axis[i][first + k];
        if (as_came || in_turn(i, command) == command) {
          out = as_came ? command : block.position[i][k];
        } else {
          out = command + (block.position[i][k] - in_turn(i, command));
        }
      }
      if (corrected.status != nullptr) corrected.status[first + k] = block.status[k];
      if (corrected.position_residual != nullptr) corrected.position_residual[first + k] = block.position_residual[k];
      if (corrected.orientation_residual != nullptr)
        corrected.orientation_residual[first + k] = block.orientation_residual[k];
    }
  }

  /// The poses that the nominal machine has at the commands.
  void nominal_goals(Block& block) const {
    pose(*nominal, block, nominal_tool, block.goal_point, block.goal_rotation, block.goal_direction, nullptr);
  }

  /// A pose that the nominal arm reaches only beyond an end of travel may be within the travel of the actual one.
  bool is_near_travel(const InverseSolution& solution) const {
    double square = 0;
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
      const double most = machine.axes[i].kind == AxisKind::linear ? options.largest_shift : options.largest_turn;
      square += std::pow(solution.excess[i] / most, 2);
    }
    return square <= 1;
  }

  /// An arm starts from the nominal solution nearest to the commands that came, which may be far away.
  void start_on_a_branch(Block& block) const {
    InverseResult found;
    std::vector<double> start(machine.axes.size());
    for (std::size_t k = 0; k < block.count; ++k) {
      if (block.active[k] == 0) continue;
      for (std::size_t i = 0; i < machine.axes.size(); ++i) start[i] = block.position[i][k];
      PoseTarget target = PoseTarget::at(vector_at(block.goal_point, k));
      target.kind = options.target;
      target.direction = vector_at(block.goal_direction, k);
      if (options.target == TargetKind::full_pose) target.orientation = matrix_at(block.goal_rotation, k);
      branches->solve(target, start.data(), found);
      if (found.solutions.empty() || !is_near_travel(found.solutions.front())) continue;
      for (std::size_t i = 0; i < machine.axes.size(); ++i) {
        block.command[i][k] = block.position[i][k] =
            found.solutions.front().position[i] - found.solutions.front().excess[i];
      }
    }
  }

  void given_goals(Block& block, const TargetArrays& targets, std::size_t first) const {
    const double* point[3] = {targets.point.x, targets.point.y, targets.point.z};
    const double* direction[3] = {targets.direction.x, targets.direction.y, targets.direction.z};
    for (std::size_t i = 0; i < 3; ++i) {
      std::copy_n(point[i] + first, block.count, block.goal_point[i].begin());
      if (options.target == TargetKind::point_and_direction) {
        std::copy_n(direction[i] + first, block.count, block.goal_direction[i].begin());
      } else {
        block.goal_direction[i].fill(i == 2 ? 1 : 0);
      }
    }
    if (options.target != TargetKind::full_pose) return;
    for (std::size_t i = 0; i < 9; ++i)
      std::copy_n(targets.rotation[i] + first, block.count, block.goal_rotation[i].begin());
  }

  /// @param goals  called as goals(block, first pose): fills in where the tool shall be
  template <typename Goals>
  void run(PositionArrays commands, const CorrectedArrays& corrected, const Goals& goals) const {
    if (!problem.empty()) {
      if (corrected.status != nullptr) std::fill_n(corrected.status, commands.count, CorrectionStatus::not_run);
      return;
    }
    Block block;
    for (std::size_t first = 0; first < commands.count; first += kBlock) {
      block.count = std::min(kBlock, commands.count - first);
      load(block, commands, first);
      goals(block, first);
      check_goals(block, options.target);
      fill_up(block);
      solve(block);
      store(block, commands, corrected, first);
    }
  }

  Machine machine;
  CorrectionOptions options;
  std::string problem;
  std::unique_ptr<CorrectionStep> stepper;
  std::optional<ChordSteps> chords;
  std::unique_ptr<InverseKinematics> branches;  // of an arm
  std::unique_ptr<ChainPlan> actual, nominal;
  std::array<Lanes, 3> actual_tool, nominal_tool;
  int along = -1;  // the column of the rotation that is the tool direction; -1: none
  Lanes zeros, ones;
  std::array<bool, kMaxAxes> repeats{};
};

CompensatedInverse::CompensatedInverse(const Machine& machine, const ErrorSet& errors, const CorrectionOptions& options,
                                       std::span<const std::size_t> held)
    : implementation_(std::make_unique<Implementation>(machine, errors, options, held)) {}
CompensatedInverse::~CompensatedInverse() = default;
CompensatedInverse::CompensatedInverse(CompensatedInverse&&) noexcept = default;
CompensatedInverse& CompensatedInverse::operator=(CompensatedInverse&&) noexcept = default;

void CompensatedInverse::correct(PositionArrays commands, const CorrectedArrays& corrected) const {
  implementation_->run(commands, corrected,
                       [this](Block& block, std::size_t) { implementation_->nominal_goals(block); });
}

void CompensatedInverse::reach(PositionArrays start, const TargetArrays& targets,
                               const CorrectedArrays& corrected) const {
  implementation_->run(start, corrected, [&](Block& block, std::size_t first) {
    implementation_->given_goals(block, targets, first);
    if (implementation_->branches) implementation_->start_on_a_branch(block);
  });
}

const std::string& CompensatedInverse::problem() const { return implementation_->problem; }

}  // namespace abbe
