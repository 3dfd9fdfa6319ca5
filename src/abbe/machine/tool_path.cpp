#include "abbe/machine/tool_path.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace abbe {
namespace {

struct Pose {
  PoseTarget target;
  std::size_t point = ToolPathStep::kNoPoint;  ///< curve point this pose is, or lies before
  bool inserted = false;
  bool working = false;
};

Eigen::Vector3d half_way(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d sum = a.normalized() + b.normalized();
  return sum.norm() > 1e-9 ? Eigen::Vector3d(sum.normalized()) : a;
}

double distance_from_chord(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d chord = b - a;
  const double squared = chord.squaredNorm();
  const double t = squared > 0 ? std::clamp((p - a).dot(chord) / squared, 0.0, 1.0) : 0.0;
  return (p - a - t * chord).norm();
}

/// How far the tool leaves the straight line while all axes run linearly from one solution to the next.
double deviation_between(const Machine& machine, const Pose& from, const Pose& to, const InverseSolution& a,
                         const InverseSolution& b) {
  std::vector<double> command(machine.axes.size());
  double largest = 0;
  for (const double t : {0.25, 0.5, 0.75}) {
    for (std::size_t i = 0; i < command.size(); ++i) command[i] = a.position[i] + t * (b.position[i] - a.position[i]);
    const Eigen::Vector3d p = nominal_workpiece_from_tool(machine, command).translation;
    largest = std::max(largest, distance_from_chord(p, from.target.point, to.target.point));
  }
  return largest;
}

class Planner {
 public:
  Planner(const Machine& machine, const Curve& curve, const ToolPathOptions& options)
      : machine_(machine), curve_(curve), options_(options), start_(options.path.start) {}

  ToolPath run() {
    result_.status = ToolPathStatus::invalid_options;
    if (curve_.points.empty()) {
      result_.message = "the curve has no points";
      return result_;
    }
    for (const CurvePoint& point : curve_.points) {
      if (point.indexed.size() != curve_.indexed.size()) {
        result_.message = "a point does not give every indexed axis its command";
        return result_;
      }
    }
    std::vector<std::size_t> begins = {0};
    for (std::size_t i = 1; i < curve_.points.size(); ++i) {
      if (curve_.points[i].indexed != curve_.points[i - 1].indexed) begins.push_back(i);
    }
    result_.regions = begins.size();
    if (begins.size() > 1 && !(options_.retract > 0)) {
      result_.status = ToolPathStatus::no_retract;
      result_.failed_point = begins[1];
      result_.message =
          fmt::format("{} regions and no distance by which the tool retracts between them", begins.size());
      return result_;
    }
    begins.push_back(curve_.points.size());
    for (std::size_t region = 0; region + 1 < begins.size(); ++region) {
      if (!plan_region(region, begins[region], begins[region + 1])) return result_;
    }
    result_.status = result_.working_jumps.empty() ? ToolPathStatus::followed : ToolPathStatus::jumps_while_working;
    if (!result_.working_jumps.empty()) {
      result_.message = fmt::format("the axes jump on {} moves on which the tool works", result_.working_jumps.size());
    }
    return result_;
  }

 private:
  std::vector<Pose> poses_of(std::size_t begin, std::size_t end) const {
    std::vector<Pose> poses;
    const auto add = [&](std::size_t point, double back) {
      const CurvePoint& at = curve_.points[point];
      Pose pose;
      pose.target = PoseTarget::at(at.point + back * at.direction.normalized(), at.direction);
      pose.point = point;
      pose.inserted = back > 0;
      pose.working = back == 0 && at.working && point > begin;
      poses.push_back(pose);
    };
    if (options_.retract > 0) add(begin, options_.retract);
    for (std::size_t i = begin; i < end; ++i) add(i, 0);
    if (options_.retract > 0) add(end - 1, options_.retract);
    return poses;
  }

  bool failed(const PathResult& path, const std::vector<Pose>& poses) {
    if (path.status == PathStatus::followed) return false;
    result_.status = path.status == PathStatus::outside_travel    ? ToolPathStatus::outside_travel
                     : path.status == PathStatus::not_reached     ? ToolPathStatus::not_reached
                     : path.status == PathStatus::start_undecided ? ToolPathStatus::start_undecided
                                                                  : ToolPathStatus::invalid_options;
    result_.failed_point = path.failed_pose < poses.size() ? poses[path.failed_pose].point : 0;
    result_.message = path.status == PathStatus::invalid_options   ? InverseKinematics(machine_, inverse_).problem()
                      : path.status == PathStatus::start_undecided ? describe(machine_, path)
                                                                   : describe(machine_, path.failure);
    return true;
  }

  bool plan_region(std::size_t region, std::size_t begin, std::size_t end) {
    PathOptions path_options = options_.path;
    path_options.start = start_;
    for (std::size_t k = 0; k < curve_.indexed.size(); ++k) {
      path_options.inverse.held.push_back({curve_.indexed[k], curve_.points[begin].indexed[k]});
    }
    inverse_ = path_options.inverse;
    std::vector<Pose> poses = poses_of(begin, end);
    PathResult path;
    while (true) {
      std::vector<PoseTarget> targets;
      for (const Pose& pose : poses) targets.push_back(pose.target);
      path = follow_path(machine_, targets, path_options);
      if (failed(path, poses)) return false;
      std::vector<Pose> finer = {poses[0]};
      largest_ = 0;
      for (std::size_t i = 1; i < poses.size(); ++i) {
        if (poses[i].working) {
          const double deviation =
              deviation_between(machine_, poses[i - 1], poses[i], path.solutions[i - 1], path.solutions[i]);
          largest_ = std::max(largest_, deviation);
          // A jump does not become less by more poses.
          if (options_.tolerance > 0 && deviation > options_.tolerance && !jumps_at(path, i)) {
            Pose middle = poses[i];
            middle.target = PoseTarget::at(0.5 * (poses[i - 1].target.point + poses[i].target.point),
                                           half_way(poses[i - 1].target.direction, poses[i].target.direction));
            middle.inserted = true;
            finer.push_back(middle);
          }
        }
        finer.push_back(poses[i]);
      }
      if (finer.size() == poses.size()) break;
      if (result_.steps.size() + finer.size() > options_.largest_count) {
        result_.status = ToolPathStatus::too_many_poses;
        result_.failed_point = begin;
        result_.message = fmt::format("more than {} poses are needed to stay within {:.3g} mm of the curve",
                                      options_.largest_count, options_.tolerance);
        return false;
      }
      poses = std::move(finer);
    }
    add_steps(region, poses, path);
    return true;
  }

  static bool jumps_at(const PathResult& path, std::size_t pose) {
    return std::any_of(path.jumps.begin(), path.jumps.end(), [&](const PathJump& jump) { return jump.pose == pose; });
  }

  void add_steps(std::size_t region, const std::vector<Pose>& poses, const PathResult& path) {
    const std::size_t first = result_.steps.size();
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const CurvePoint& at = curve_.points[poses[i].point];
      ToolPathStep step;
      step.command = path.solutions[i].position;
      step.branch = path.solutions[i].branch;
      step.region = region;
      step.working = poses[i].working;
      step.feed = at.feed;
      if (!poses[i].inserted) {
        step.point = poses[i].point;
        step.dwell = at.dwell;
      } else if (poses[i].working) {
        ++result_.inserted;
      }
      if (step.working) {
        step.length = (poses[i].target.point - poses[i - 1].target.point).norm();
        result_.working_length += step.length;
        if (step.feed > 0) result_.working_time += step.length / step.feed;
      }
      result_.working_time += step.dwell;
      result_.steps.push_back(step);
    }
    for (PathJump jump : path.jumps) {
      jump.pose += first;
      if (result_.steps[jump.pose].working) result_.working_jumps.push_back(jump.pose);
      result_.jumps.push_back(jump);
    }
    result_.largest_deviation = std::max(result_.largest_deviation, largest_);
    const auto& last = path.solutions.back().position;
    start_.assign(last.begin(), last.begin() + static_cast<std::ptrdiff_t>(machine_.axes.size()));
  }

  const Machine& machine_;
  const Curve& curve_;
  const ToolPathOptions& options_;
  std::vector<double> start_;
  InverseOptions inverse_;
  ToolPath result_;
  double largest_ = 0;
};

}  // namespace

std::vector<WorkingRun> working_runs(const Curve& curve) {
  std::vector<WorkingRun> runs;
  bool working = false;
  for (std::size_t i = 1; i < curve.points.size(); ++i) {
    const bool was_working = working;
    working = curve.points[i].working && curve.points[i].indexed == curve.points[i - 1].indexed;
    if (working && !was_working) runs.push_back({i - 1, i});
    if (working) runs.back().last = i;
  }
  return runs;
}

ToolPath plan_tool_path(const Machine& machine, const Curve& curve, const ToolPathOptions& options) {
  return Planner(machine, curve, options).run();
}

}  // namespace abbe
