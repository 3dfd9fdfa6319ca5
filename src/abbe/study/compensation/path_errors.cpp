#include "abbe/study/compensation/path_errors.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "abbe/compensate/compensated_inverse.h"
#include "abbe/errors/actual_pose.h"
#include "abbe/errors/error_states.h"
#include "abbe/geometry/angle.h"

namespace abbe {
namespace {

constexpr double kStandsStill = 1e-9;  // mm or rad: a smaller difference of commands is no motion
constexpr int kMostRounds = 8;         // of sides of approach that follow from commands corrected for them

/// From which side every axis comes to each pose, by the commands; 0 until it has moved.
std::vector<std::vector<std::int8_t>> sides_of(const PoseList& poses) {
  std::vector<std::vector<std::int8_t>> sides(poses.axis.size());
  for (std::size_t i = 0; i < sides.size(); ++i) {
    std::int8_t side = 0;
    for (std::size_t k = 0; k < poses.count(); ++k) {
      const double moved = k == 0 ? 0 : poses.axis[i][k] - poses.axis[i][k - 1];
      if (std::abs(moved) > kStandsStill) side = moved > 0 ? 1 : -1;
      sides[i].push_back(side);
    }
  }
  return sides;
}

double from_chord(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d chord = b - a;
  const double squared = chord.squaredNorm();
  const double t = squared > 0 ? std::clamp((p - a).dot(chord) / squared, 0.0, 1.0) : 0.0;
  return (p - a - t * chord).norm();
}

class PathCorrection {
 public:
  PathCorrection(const PathRequest& request, const Machine& machine, const std::vector<double>& zero,
                 PlannedPath& planned)
      : request_(request),
        machine_(machine),
        errors_(request.errors->errors),
        states_(machine, errors_),
        zero_(zero),
        planned_(planned) {
    for (const std::vector<double>& command : planned.commands) start_.append(command);
    for (const ToolPathStep& step : planned.path.steps) {
      const RigidTransform pose =
          nominal_workpiece_from_tool(planned.machine, std::span(step.command).first(machine.axes.size()));
      points_.push_back(pose.translation);
      directions_.emplace_back(pose.rotation * machine.tool_direction);
    }
  }

  bool correct() {
    std::vector<std::size_t> held = request_.curve.indexed;
    for (const HeldAxis& axis : request_.held) held.push_back(axis.axis);
    const CompensatedInverse inverse(machine_, errors_, {}, held);
    if (!inverse.problem().empty()) {
      planned_.refused = inverse.problem();
      return false;
    }
    start_.approach = sides_of(start_);
    for (int round = 0; round < kMostRounds; ++round) {
      reach(inverse);
      if (!planned_.refused.empty()) return false;
      std::vector<std::vector<std::int8_t>> sides = sides_of(corrected_);
      if (!states_.any() || sides == start_.approach) return true;
      start_.approach = std::move(sides);
    }
    planned_.refused = "the sides of approach follow from commands that are corrected for them, and do not settle";
    return false;
  }

  void state_result(const Curve& curve) {
    planned_.miss = {};
    double deviation = 0;
    for (std::size_t k = 0; k < points_.size(); ++k) {
      ToolPathStep& step = planned_.path.steps[k];
      planned_.commands[k] = corrected_.pose(k);
      for (std::size_t i = 0; i < zero_.size(); ++i) step.command[i] = planned_.commands[k][i] + zero_[i];
      if (step.working && k > 0) deviation = std::max(deviation, deviation_on_the_way_to(k));
      if (step.point == ToolPathStep::kNoPoint) continue;
      const RigidTransform pose =
          actual_workpiece_from_tool(machine_, errors_, planned_.commands[k], states_.at(start_, k));
      const CurvePoint& at = curve.points[step.point];
      planned_.miss.distance = std::max(planned_.miss.distance, (pose.translation - at.point).norm());
      planned_.miss.angle =
          std::max(planned_.miss.angle, angle_between(pose.rotation * machine_.tool_direction, at.direction));
    }
    planned_.path.largest_deviation = deviation;
    if (request_.tolerance > 0 && deviation > request_.tolerance) {
      planned_.refused = fmt::format(
          "with the errors along the path the tool leaves the lines between the points by {:.3f} um, which is more "
          "than --tolerance-um {:g}: a curve with more points, or a larger tolerance",
          1e3 * deviation, 1e3 * request_.tolerance);
    }
  }

 private:
  void reach(const CompensatedInverse& inverse) {
    const std::size_t count = start_.count();
    corrected_ = start_;
    std::vector<double*> out;
    for (std::vector<double>& axis : corrected_.axis) out.push_back(axis.data());
    std::vector<const double*> in;
    for (const std::vector<double>& axis : start_.axis) in.push_back(axis.data());
    std::vector<std::size_t> all(count);
    for (std::size_t k = 0; k < count; ++k) all[k] = k;
    std::vector<double> memory;
    std::vector<const double*> given;
    states_.gather(start_, all, memory, given);
    std::array<std::vector<double>, 6> targets;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t k = 0; k < count; ++k) {
        targets[i].push_back(points_[k][static_cast<Eigen::Index>(i)]);
        targets[3 + i].push_back(directions_[k][static_cast<Eigen::Index>(i)]);
      }
    }
    TargetArrays wanted;
    wanted.point = {targets[0].data(), targets[1].data(), targets[2].data()};
    wanted.direction = {targets[3].data(), targets[4].data(), targets[5].data()};
    std::vector<CorrectionStatus> status(count, CorrectionStatus::not_run);
    inverse.reach({in, count, given}, wanted, {.axis = out, .status = status.data()});
    for (std::size_t k = 0; k < count; ++k) {
      if (reaches_point(status[k])) continue;
      planned_.refused = fmt::format("pose {} of {} ({}): {}", k + 1, count, place_of(k),
                                     status[k] == CorrectionStatus::not_covered ? "the errors are not known there"
                                                                                : correction_status_text(status[k]));
      return;
    }
  }

  std::string place_of(std::size_t k) const {
    return fmt::format("{:.3f}, {:.3f}, {:.3f} mm", points_[k].x(), points_[k].y(), points_[k].z());
  }

  /// Of the actual tool from the line between the points; the sides of approach are those of the move.
  double deviation_on_the_way_to(std::size_t k) const {
    const std::vector<double> given = states_.at(start_, k), from = corrected_.pose(k - 1), to = corrected_.pose(k);
    std::vector<double> command(from.size());
    double largest = 0;
    for (const double t : {0.25, 0.5, 0.75}) {
      for (std::size_t i = 0; i < command.size(); ++i) command[i] = from[i] + t * (to[i] - from[i]);
      const Eigen::Vector3d p = actual_workpiece_from_tool(machine_, errors_, command, given).translation;
      largest = std::max(largest, from_chord(p, points_[k - 1], points_[k]));
    }
    return largest;
  }

  const PathRequest& request_;
  const Machine& machine_;
  const ErrorSet& errors_;
  GivenStates states_;
  const std::vector<double>& zero_;
  PlannedPath& planned_;
  PoseList start_, corrected_;
  std::vector<Eigen::Vector3d> points_, directions_;  // [poses] where the calibrated machine has the tool
};

}  // namespace

ErrorsOfPath errors_of_path(const Machine& machine, const ErrorSet& errors) {
  ErrorsOfPath result{errors, {}};
  result.constant.motions.clear();
  result.constant.locations.clear();
  const auto note = [&](const std::string& name) {
    if (std::find(result.along.begin(), result.along.end(), name) == result.along.end()) result.along.push_back(name);
  };
  for (const ErrorMotion& motion : errors.motions) {
    const bool moves = std::any_of(motion.coefficients.begin(), motion.coefficients.end(),
                                   [](double coefficient) { return coefficient != 0; });
    if (moves) note(error_motion_name(machine, motion.axis, motion.component, motion.state));
  }
  for (const LocationError& location : errors.locations) {
    if (location.state == kNoState) {
      result.constant.locations.push_back(location);
    } else if (location.value != 0) {
      note(location_error_name(machine, location.axis, location.component, location.state));
    }
  }
  return result;
}

void correct_along_path(const PathRequest& request, const Machine& machine, const std::vector<double>& zero,
                        const Curve& curve, PlannedPath& planned) {
  PathCorrection correction(request, machine, zero, planned);
  if (correction.correct()) {
    correction.state_result(curve);
    return;
  }
  // Commands that are not corrected are none.
  planned.path.status = ToolPathStatus::not_reached;
  planned.path.message = planned.refused;
  planned.commands.clear();
}

}  // namespace abbe
