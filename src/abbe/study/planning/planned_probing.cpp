#include "abbe/study/planning/planned_probing.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <utility>

#include "abbe/formats/files/file_name.h"
#include "abbe/formats/nc/measuring_program.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/list_text.h"
#include "abbe/machine/position_words.h"
#include "abbe/plan/ways/linear_motion.h"

namespace abbe {
namespace {

void check_probing(const ProbingRequest& request) {
  if (!request.ball_centre.allFinite()) {
    throw InputError({.field = "--probe-ball-mm"}, "the centre is not finite", "X, Y and Z of the centre in mm");
  }
  const auto above_zero = [](const char* option, double length) {
    if (!(length > 0)) throw InputError({.field = option}, "is not above zero", "a length in mm");
    if (!std::isfinite(length)) throw InputError({.field = option}, "is not finite", "a length in mm");
  };
  above_zero("--probe-ball-mm", request.ball_radius);
  above_zero("--tip-radius-mm", request.tip_radius);
  above_zero("--pre-touch-mm", request.before);
  above_zero("--over-travel-mm", request.beyond);
  if (request.touches < 4) {
    throw InputError({.field = "--touches-per-ball"},
                     fmt::format("{} touches do not determine a ball", request.touches), "at least 4");
  }
  if (request.list.readings.empty())
    throw InputError({.file = request.readings_file}, "has no reading", "at least one");
}

/// Directions from the centre of the ball to the touches, frame of the tool: along the tool first, then around it.
std::vector<Eigen::Vector3d> touch_directions(const Machine& machine, std::size_t touches) {
  const Eigen::Vector3d along = machine.tool_direction;
  // The first one is along X, or along Y for a tool along X.
  const Eigen::Vector3d first = std::abs(along.x()) < 0.9 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY();
  const Eigen::Vector3d x = (first - first.dot(along) * along).normalized(), y = along.cross(x);
  std::vector<Eigen::Vector3d> directions = {along};
  for (std::size_t k = 1; k < touches; ++k) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(k - 1) / static_cast<double>(touches - 1);
    Eigen::Vector3d direction = std::cos(angle) * x + std::sin(angle) * y;
    // What rounding leaves of a quarter of a turn.
    for (double& component : direction) component = std::abs(component) < 1e-15 ? 0 : component;
    directions.push_back(direction);
  }
  return directions;
}

class ProbingPlanner {
 public:
  ProbingPlanner(const ProbingRequest& request, PlannedProbing& planned)
      : request_(request),
        planned_(planned),
        machine_(planned.machine),
        obstacles_(with_ball(request)),
        directions_(touch_directions(machine_, request.touches)),
        clear_(machine_, obstacles_, tool(request), request.ways),
        of_others_(machine_, request.obstacles, tool(request), request.ways),
        touching_(request.ball_radius + request.tip_radius),
        away_(touching_ + request.before) {}

  /// @returns the steps of the program; nothing if one of them cannot be made, which is then told
  std::optional<std::vector<ProbingStep>> steps() {
    std::vector<ProbingStep> steps;
    for (std::size_t k = 0; k < request_.list.readings.size(); ++k) {
      const ListedReading& reading = request_.list.readings[k];
      words_ = reading_words(k + 1, reading);
      std::optional<ProbingStep> step = ball(reading, fmt::format("reading {}", k + 1));
      if (!step) return std::nullopt;
      steps.push_back(std::move(*step));
    }
    planned_.positions = steps.size();
    return steps;
  }

 private:
  static std::vector<Obstacle> with_ball(const ProbingRequest& request) {
    std::vector<Obstacle> obstacles = request.obstacles;
    obstacles.push_back({"the ball", ball_mesh(request.ball_centre, request.ball_radius), ObstacleCarrier::table, 0});
    return obstacles;
  }
  static ToolShape tool(const ProbingRequest& request) {
    return {std::max(request.tool.radius, request.tip_radius), request.tool.length};
  }

  /// Notes the first reason why there is no program. @returns false
  bool refuse(const std::string& problem) {
    if (planned_.refused.empty()) planned_.refused = fmt::format("{}: {}: {}", planned_.readings_file, words_, problem);
    return false;
  }
  bool refuse(const WayCollision& collision) {
    return refuse(fmt::format("the tool touches {} at {}", obstacles_[collision.obstacle].name,
                              position_words(machine_, collision.pose, "{:.3f}")));
  }

  /// Commands with the tip at a place relative to the centre of the ball.
  /// @param from  frame of the tool, mm
  std::optional<std::vector<double>> tip_at(const std::vector<double>& pose, const Eigen::Vector3d& from) {
    const RigidTransform bed_from_tool = nominal_bed_from_tool(machine_, pose);
    const Eigen::Vector3d ball = nominal_bed_from_workpiece(machine_, pose) * request_.ball_centre;
    const std::optional<std::vector<double>> moved =
        moved_linearly(machine_, pose, ball + bed_from_tool.rotation * from - bed_from_tool.translation);
    if (!moved) {
      refuse("the linear axes cannot bring the probe to the ball");
      return std::nullopt;
    }
    for (std::size_t i = 0; i < pose.size(); ++i) {
      const Axis& axis = machine_.axes[i];
      if (axis.kind == AxisKind::rotary || ((*moved)[i] >= axis.travel_min && (*moved)[i] <= axis.travel_max)) continue;
      refuse(fmt::format("the ball is out of reach: {} {:.3f} mm is outside the travel of {:g} to {:g} mm", axis.name,
                         (*moved)[i], axis.travel_min, axis.travel_max));
      return std::nullopt;
    }
    return stated_pose(machine_, *moved, request_.program.decimals);
  }

  /// Adds a move that keeps clear of everything.
  bool go(ProbingStep& step, const std::vector<double>& pose) {
    if (at_ == pose) return true;
    if (at_) {
      if (const std::optional<WayCollision> collision = clear_.straight(*at_, pose)) return refuse(*collision);
    }
    step.moves.push_back({pose, false});
    at_ = pose;
    return true;
  }

  /// To the first pose over a ball, by a way around if need be.
  bool arrive(ProbingStep& step, const std::vector<double>& pose) {
    if (!at_) {
      if (const std::optional<WayCollision> collision = clear_.standing(pose)) return refuse(*collision);
      return go(step, pose);
    }
    const Way way = clear_.find(*at_, pose);
    if (!way.is_clear) return refuse(*way.collision);
    for (const std::vector<double>& via : way.via) {
      if (!go(step, stated_pose(machine_, via, request_.program.decimals))) return false;
    }
    planned_.ways_around += way.via.empty() ? 0 : 1;
    return go(step, pose);
  }

  std::optional<ProbingStep> ball(const ListedReading& reading, const std::string& name) {
    ProbingStep step;
    step.words = name + (reading.what.empty() ? "" : ", " + request_.list.what + " " + reading.what);
    const Eigen::Vector3d over = away_ * directions_[0];
    const std::optional<std::vector<double>> above = tip_at(reading.pose, over);
    if (!above || !arrive(step, *above)) return std::nullopt;
    for (std::size_t k = 0; k < directions_.size(); ++k) {
      const Eigen::Vector3d beside = away_ * directions_[k];
      const std::optional<std::vector<double>> high =
                                                   tip_at(reading.pose, k == 0 ? over : Eigen::Vector3d(over + beside)),
                                               begin = tip_at(reading.pose, beside),
                                               contact = tip_at(reading.pose, touching_ * directions_[k]),
                                               end =
                                                   tip_at(reading.pose, (touching_ - request_.beyond) * directions_[k]);
      if (!high || !begin || !contact || !end || !go(step, *high) || !go(step, *begin)) return std::nullopt;
      if (const std::optional<WayCollision> collision = of_others_.straight(*begin, *end)) {
        refuse(*collision);
        return std::nullopt;
      }
      step.moves.push_back({*end, true});
      step.moves.push_back({*begin, false});
      // Zero minus it, so that no component is a negative zero.
      planned_.touches.push_back({*contact, Eigen::Vector3d::Zero() - directions_[k], request_.before + request_.beyond,
                                  reading.what, fmt::format("{}, touch {}", name, k + 1)});
      if (!go(step, *high)) return std::nullopt;
    }
    // Over the ball again, from where the next way begins.
    if (!go(step, *above)) return std::nullopt;
    return step;
  }

  const ProbingRequest& request_;
  PlannedProbing& planned_;
  const Machine& machine_;
  std::vector<Obstacle> obstacles_;
  std::vector<Eigen::Vector3d> directions_;
  ClearWays clear_, of_others_;
  double touching_, away_;  ///< mm, from the centre of the ball to that of the tip
  std::string words_;
  std::optional<std::vector<double>> at_;
};

}  // namespace

ProbingRequest probing_request(const MeasurementRequest& measurement) {
  if (measurement.program.dialect != NcDialect::linuxcnc) {
    throw InputError({.field = "--probe-ball-mm"}, "touches are written for LinuxCNC only", "--dialect linuxcnc");
  }
  ProbingRequest request;
  request.machine = measurement.machine;
  request.list = measurement.list;
  request.readings_file = measurement.readings_file;
  request.obstacles = measurement.obstacles;
  request.tool = measurement.tool;
  request.ways = measurement.ways;
  request.program.words = measurement.program.words;
  request.program.decimals = measurement.program.decimals.value_or(request.program.decimals);
  request.program.feed = measurement.program.feed;
  request.program.dwell = measurement.program.dwell;
  return request;
}

PlannedProbing plan_probing(const ProbingRequest& request) {
  check_probing(request);
  PlannedProbing planned;
  planned.machine = request.machine;
  planned.readings_file = request.readings_file;
  const std::optional<std::vector<ProbingStep>> steps = ProbingPlanner(request, planned).steps();
  if (!steps) return planned;
  ProbingProgramOptions options = request.program;
  const Eigen::Vector3d& centre = request.ball_centre;
  options.comments.insert(
      options.comments.begin(),
      {fmt::format("{} touches of a ball at {}, {}, {} mm on {}", planned.touches.size(), centre.x(), centre.y(),
                   centre.z(), planned.machine.name),
       "positions are those of " + file_name(planned.readings_file) + " and of the machine file, without tool length"});
  planned.program = probing_program(planned.machine, *steps, options);
  return planned;
}

std::string planned_probing_text(const PlannedProbing& planned) {
  if (!planned.refused.empty()) return "";
  return fmt::format("{}: {} of a ball at {} of the rotary axes, {} around it\n", planned.machine.name,
                     counted(planned.touches.size(), "touch", "touches"),
                     counted(planned.positions, "position", "positions"), counted(planned.ways_around, "way", "ways")) +
         "note: the way to the first position is not checked\n";
}

nlohmann::ordered_json planned_probing_json(const PlannedProbing& planned) {
  nlohmann::ordered_json json = {{"format", "abbe-probing-program/1"},
                                 {"machine", planned.machine.name},
                                 {"readings_file", planned.readings_file}};
  if (!planned.refused.empty()) {
    json["refused"] = planned.refused;
    return json;
  }
  json["touches"] = planned.touches.size();
  json["positions"] = planned.positions;
  json["ways_around"] = planned.ways_around;
  return json;
}

}  // namespace abbe
