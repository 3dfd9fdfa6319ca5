#include "abbe/machine/path.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "abbe/geometry/angle.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/geometry/rotation.h"
#include "abbe/machine/coupling.h"
#include "abbe/machine/orientation.h"

namespace abbe {
namespace {

/// Cost of a jump (mm): more than any machine moves along a path, so that jumps are counted first.
constexpr double kJumpCost = 1e9;
/// Of the move between two beginnings: distances from the start that differ less do not tell which of them is meant.
constexpr double kStartDecides = 1e-3;

/// mm per rad: so little that it decides between turns only.
constexpr double kShorterTurn = 1e-6;

using Nodes = std::vector<InverseSolution>;

/// Shortest-path search over the solutions of all poses.
class PathSearch {
 public:
  PathSearch(const Machine& machine, std::span<const PoseTarget> path, const PathOptions& options)
      : machine_(machine), path_(path), options_(options), inverse_(machine, all_turns(options.inverse)) {}

  PathResult run() {
    PathResult result;
    const bool start_fits = options_.start.empty() || options_.start.size() == machine_.axes.size();
    if (!inverse_.problem().empty() || !start_fits) {
      result.status = PathStatus::invalid_options;
      return result;
    }
    const std::vector<double> start = known_start();
    for (std::size_t i = 0; i < path_.size(); ++i) {
      const InverseResult found = inverse_.solve(path_[i], start);
      if (found.status != InverseStatus::solved) {
        result.status =
            found.status == InverseStatus::outside_travel ? PathStatus::outside_travel : PathStatus::not_reached;
        result.failed_pose = i;
        result.failure = found;
        return result;
      }
      nodes_.push_back(within_travel(found));
    }
    give_free_axes_their_neighbours_commands();
    search(result);
    if (!result.undecided.empty()) {
      result.solutions.clear();
      result.status = PathStatus::start_undecided;
      return result;
    }
    list_jumps(result);
    result.status = PathStatus::followed;
    return result;
  }

 private:
  static InverseOptions all_turns(InverseOptions options) {
    options.all_turns = true;
    return options;
  }

  /// The start for the inverse kinematics, which takes turns and free axes from it: where nothing is known, the command
  /// nearest to zero within travel, as without a start.
  std::vector<double> known_start() const {
    std::vector<double> start = options_.start;
    for (std::size_t i = 0; i < start.size(); ++i) {
      const Axis& axis = machine_.axes[i];
      if (std::isnan(start[i])) start[i] = axis.endless ? 0 : std::clamp(0.0, axis.travel_min, axis.travel_max);
    }
    return start;
  }

  static Nodes within_travel(const InverseResult& result) {
    Nodes nodes;
    for (const InverseSolution& solution : result.solutions) {
      if (solution.within_travel) nodes.push_back(solution);
    }
    return nodes;
  }

  static bool has_free_axis(const InverseSolution& solution) { return solution.singular_axis != Machine::npos; }
  static bool has_free_axis(const Nodes& nodes) {
    return std::any_of(nodes.begin(), nodes.end(), [](const InverseSolution& s) { return has_free_axis(s); });
  }

  /// Where an axis is free its useful commands are those that the poses before and after the singular stretch give it.
  void give_free_axes_their_neighbours_commands() {
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      if (!has_free_axis(nodes_[i])) continue;
      std::size_t before = i, after = i;
      while (before > 0 && has_free_axis(nodes_[before])) --before;
      while (after + 1 < nodes_.size() && has_free_axis(nodes_[after])) ++after;
      const Nodes original = nodes_[i];
      pending_.push_back({i, {}});
      for (const InverseSolution& solution : original) {
        pending_.back().nodes.push_back(solution);
        if (!has_free_axis(solution)) continue;
        for (const std::size_t neighbour : {before, after}) {
          for (const InverseSolution& other : nodes_[neighbour]) {
            add_with_command(i, other.position[solution.singular_axis], solution, pending_.back().nodes);
          }
        }
      }
    }
    for (Pending& pending : pending_) nodes_[pending.pose] = std::move(pending.nodes);
  }

  void add_with_command(std::size_t pose, double command, const InverseSolution& like, Nodes& nodes) const {
    const std::size_t axis = like.singular_axis;
    for (const InverseSolution& node : nodes) {
      if (node.singular_axis == axis && std::abs(node.position[axis] - command) < 1e-12) return;
    }
    std::vector<double> start(like.position.begin(),
                              like.position.begin() + static_cast<std::ptrdiff_t>(machine_.axes.size()));
    start[axis] = command;
    for (const InverseSolution& solution : within_travel(inverse_.solve(path_[pose], start))) {
      if (solution.singular_axis == axis) nodes.push_back(solution);
    }
  }

  double move(std::size_t axis, const InverseSolution& from, const InverseSolution& to) const {
    const double difference = to.position[axis] - from.position[axis];
    return machine_.axes[axis].endless ? std::remainder(difference, kTurn) : difference;
  }

  double length(const InverseSolution& from, const InverseSolution& to) const {
    double sum = 0;
    for (std::size_t i = 0; i < machine_.axes.size(); ++i) {
      const double weight = machine_.axes[i].kind == AxisKind::rotary ? options_.mm_per_radian : 1;
      const double moved = weight * move(i, from, to);
      sum += moved * moved;
    }
    return std::sqrt(sum);
  }

  /// How far the path itself turns the tool from one pose to the next, rad.
  double turn_of_tool(std::size_t pose) const {
    const PoseTarget &from = path_[pose - 1], &to = path_[pose];
    if (from.kind != to.kind || to.kind == TargetKind::point) return 0;
    if (to.kind == TargetKind::point_and_direction) return angle_between(from.direction, to.direction);
    return rotation_vector(from.orientation.transpose() * to.orientation).norm();
  }

  /// The rotary axis that turns most, and by how much.
  std::size_t most_turned(const InverseSolution& from, const InverseSolution& to, double& turn) const {
    std::size_t most = Machine::npos;
    turn = 0;
    for (std::size_t i = 0; i < machine_.axes.size(); ++i) {
      if (machine_.axes[i].kind != AxisKind::rotary) continue;
      const double turned = move(i, from, to);
      if (most == Machine::npos || std::abs(turned) > std::abs(turn)) most = i, turn = turned;
    }
    return most;
  }

  bool is_jump(double turn, double tool_turn) const {
    return std::abs(turn) > std::max(options_.largest_turn, 3 * tool_turn);
  }

  /// Where the axis that turns is free the tool keeps its direction meanwhile: the better place for a jump.
  double jump_cost(const InverseSolution& from, const InverseSolution& to, double tool_turn) const {
    double turn = 0;
    const std::size_t axis = most_turned(from, to, turn);
    if (!is_jump(turn, tool_turn)) return 0;
    return from.singular_axis == axis || to.singular_axis == axis ? 0.999 * kJumpCost : kJumpCost;
  }

  bool start_is_known(std::size_t axis) const { return !options_.start.empty() && !std::isnan(options_.start[axis]); }

  /// The same branch, a rotary axis whole turns further.
  bool differ_by_turns(const InverseSolution& one, const InverseSolution& other) const {
    std::array<double, kMaxAxes> of_one, of_other;
    positions_of_commands(machine_, one.position.data(), of_one.data());
    positions_of_commands(machine_, other.position.data(), of_other.data());
    for (std::size_t i = 0; i < machine_.axes.size(); ++i) {
      const double difference = of_other[i] - of_one[i];
      const bool rotary = machine_.axes[i].kind == AxisKind::rotary;
      if (std::abs(rotary ? std::remainder(difference, kTurn) : difference) > 1e-6) return false;
    }
    return true;
  }

  /// [first nodes] over the axes of which the start is known; zero without a start. Of several turns of an axis that it
  /// does not name, the one nearest to zero is a little shorter.
  std::vector<double> lengths_from_start() const {
    std::vector<double> lengths;
    for (const InverseSolution& first : nodes_[0]) {
      InverseSolution start = first;
      for (std::size_t i = 0; i < machine_.axes.size(); ++i) {
        if (start_is_known(i)) start.position[i] = options_.start[i];
      }
      double turns = 0;
      for (std::size_t i = 0; i < options_.start.size(); ++i) {
        if (!start_is_known(i) && machine_.axes[i].kind == AxisKind::rotary && !machine_.axes[i].endless)
          turns += std::abs(first.position[i]);
      }
      lengths.push_back(length(start, first) + kShorterTurn * turns);
    }
    return lengths;
  }

  double step_cost(const InverseSolution& from, const InverseSolution& to, double tool_turn) const {
    return length(from, to) + jump_cost(from, to, tool_turn);
  }

  /// [first nodes] cost of the best sequence that begins there.
  std::vector<double> costs_of_beginnings() const {
    std::vector<double> cost(nodes_.back().size(), 0.0), next;
    for (std::size_t pose = nodes_.size(); pose-- > 1;) {
      const Nodes &before = nodes_[pose - 1], &here = nodes_[pose];
      const double tool_turn = turn_of_tool(pose);
      next.assign(before.size(), std::numeric_limits<double>::infinity());
      for (std::size_t j = 0; j < before.size(); ++j) {
        for (std::size_t k = 0; k < here.size(); ++k) {
          next[j] = std::min(next[j], step_cost(before[j], here[k], tool_turn) + cost[k]);
        }
      }
      cost.swap(next);
    }
    return cost;
  }

  /// Axes that the start leaves out and of which another beginning has other commands, though it is as near to the
  /// start by the axes given and leads to no more jumps.
  std::vector<std::size_t> axes_that_would_decide(std::size_t chosen) const {
    std::vector<std::size_t> axes;
    const bool partly_known =
        std::any_of(options_.start.begin(), options_.start.end(), [](double command) { return std::isnan(command); });
    if (!partly_known) return axes;
    const std::vector<double> from_start = lengths_from_start(), onwards = costs_of_beginnings();
    const InverseSolution& best = nodes_[0][chosen];
    for (std::size_t i = 0; i < machine_.axes.size(); ++i) {
      if (start_is_known(i)) continue;
      for (std::size_t k = 0; k < nodes_[0].size(); ++k) {
        const InverseSolution& other = nodes_[0][k];
        const double apart = length(best, other);
        const double weight = machine_.axes[i].kind == AxisKind::rotary ? options_.mm_per_radian : 1;
        const bool as_near = std::abs(from_start[k] - from_start[chosen]) <= kStartDecides * apart;
        if (differ_by_turns(best, other)) continue;
        const bool as_smooth = onwards[k] < onwards[chosen] + 0.0005 * kJumpCost;
        if (as_near && as_smooth && weight * std::abs(move(i, best, other)) > 0.01 * apart) {
          axes.push_back(i);
          break;
        }
      }
    }
    return axes;
  }

  void search(PathResult& result) const {
    if (nodes_.empty()) return;
    std::vector<std::vector<std::size_t>> came_from(nodes_.size());
    std::vector<double> cost = lengths_from_start(), next;
    for (std::size_t pose = 1; pose < nodes_.size(); ++pose) {
      const Nodes &before = nodes_[pose - 1], &here = nodes_[pose];
      const double tool_turn = turn_of_tool(pose);
      next.assign(here.size(), std::numeric_limits<double>::infinity());
      came_from[pose].assign(here.size(), 0);
      for (std::size_t k = 0; k < here.size(); ++k) {
        for (std::size_t j = 0; j < before.size(); ++j) {
          const double total = cost[j] + step_cost(before[j], here[k], tool_turn);
          if (total < next[k]) next[k] = total, came_from[pose][k] = j;
        }
      }
      cost.swap(next);
    }
    std::size_t k = static_cast<std::size_t>(std::min_element(cost.begin(), cost.end()) - cost.begin());
    result.solutions.resize(nodes_.size());
    for (std::size_t pose = nodes_.size(); pose-- > 0;) {
      result.solutions[pose] = nodes_[pose][k];
      if (pose > 0) k = came_from[pose][k];
    }
    result.undecided = axes_that_would_decide(k);
    for (std::size_t pose = 1; pose < nodes_.size(); ++pose) {
      result.length += length(result.solutions[pose - 1], result.solutions[pose]);
      unwind(result.solutions[pose - 1], result.solutions[pose]);
    }
  }

  void unwind(const InverseSolution& before, InverseSolution& here) const {
    for (std::size_t i = 0; i < machine_.axes.size(); ++i) {
      if (!machine_.axes[i].endless) continue;
      const double turns = std::round((before.position[i] - here.position[i]) / kTurn);
      here.position[i] += turns * kTurn;
    }
  }

  void list_jumps(PathResult& result) const {
    for (std::size_t pose = 1; pose < result.solutions.size(); ++pose) {
      const InverseSolution &from = result.solutions[pose - 1], &to = result.solutions[pose];
      PathJump jump;
      jump.axis = most_turned(from, to, jump.turn);
      if (!is_jump(jump.turn, turn_of_tool(pose))) continue;
      jump.pose = pose;
      jump.leaves_singular_pose = from.singular_axis == jump.axis || to.singular_axis == jump.axis;
      std::array<double, kMaxAxes> half_way{};
      for (std::size_t i = 0; i < machine_.axes.size(); ++i) {
        half_way[i] = 0.5 * (from.position[i] + to.position[i]);
        if (machine_.axes[i].kind == AxisKind::rotary) continue;
        jump.largest_linear_move = std::max(jump.largest_linear_move, std::abs(move(i, from, to)));
      }
      const Eigen::Vector3d tool =
          nominal_workpiece_from_tool(machine_, std::span<const double>(half_way.data(), machine_.axes.size()))
              .translation;
      jump.point_deviation = (tool - 0.5 * (path_[pose - 1].point + path_[pose].point)).norm();
      result.jumps.push_back(jump);
    }
  }

  struct Pending {
    std::size_t pose;
    Nodes nodes;
  };

  const Machine& machine_;
  std::span<const PoseTarget> path_;
  const PathOptions& options_;
  InverseKinematics inverse_;
  std::vector<Nodes> nodes_;      ///< per pose, all within travel
  std::vector<Pending> pending_;  ///< nodes of singular poses, exchanged when all have been looked at
};

/// "A", "A or C", "X, A or C".
std::string joined_names(const Machine& machine, const std::vector<std::size_t>& axes) {
  std::string text;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    if (i > 0) text += i + 1 == axes.size() ? " or " : ", ";
    text += machine.axes[axes[i]].name;
  }
  return text;
}

std::string four_digits(double value) { return fmt::format("{:.4g}", value); }

}  // namespace

PathResult follow_path(const Machine& machine, std::span<const PoseTarget> path, const PathOptions& options) {
  return PathSearch(machine, path, options).run();
}

std::string describe(const Machine& machine, const PathResult& result) {
  const std::string failed = "pose " + std::to_string(result.failed_pose) + ": ";
  switch (result.status) {
    case PathStatus::not_run:
      return "not run";
    case PathStatus::outside_travel:
    case PathStatus::not_reached:
      return failed + describe(machine, result.failure);
    case PathStatus::start_undecided:
      return "the start does not decide between the branches: it needs a command of " +
             joined_names(machine, result.undecided);
    case PathStatus::invalid_options:
      return "the machine or the options are not usable";
    case PathStatus::followed:
      break;
  }
  std::string text =
      std::to_string(result.solutions.size()) + " poses followed, " +
      (result.jumps.empty() ? std::string("no jump") : std::to_string(result.jumps.size()) + " with a jump");
  for (const PathJump& jump : result.jumps) {
    text += "\npose " + std::to_string(jump.pose) + ": " + machine.axes[jump.axis].name + " turns " +
            four_digits(jump.turn / kDegree) + " deg" + (jump.leaves_singular_pose ? " in a singular pose" : "") +
            ", linear axes move up to " + four_digits(jump.largest_linear_move) + " mm, tool " +
            four_digits(jump.point_deviation) + " mm off half way";
  }
  return text;
}

}  // namespace abbe
