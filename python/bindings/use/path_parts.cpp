#include "bindings/use/path_parts.h"

#include <fmt/format.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include "abbe/machine/inverse_kinematics.h"

namespace abbe::python {
namespace {

/// A path of poses with its machine.
struct FollowedPath {
  Machine machine;
  PathResult result;
};

std::vector<PoseTarget> targets_of(const ArrayLike& points, const std::optional<ArrayLike>& directions,
                                   const std::optional<ArrayLike>& rotations) {
  if (directions && rotations) {
    throw InputError({.field = "rotations"}, "is given together with directions", "one of them");
  }
  const Rows point(points, "points_mm", 3, "points in the workpiece frame, mm");
  if (point.single()) throw InputError({.field = "points_mm"}, "is a single point", "shape (n, 3), mm");
  const std::size_t count = point.count();
  std::optional<Rows> direction;
  std::optional<Numbers> rotation;
  if (directions) direction.emplace(*directions, "directions", 3, "from the functional point to the spindle");
  if (rotations) {
    rotation = rotations->numbers("rotations");
    if (rotation->ndim() != 3 || rotation->shape(0) != count || rotation->shape(1) != 3 || rotation->shape(2) != 3) {
      throw InputError({.field = "rotations"}, "has another shape", fmt::format("shape ({}, 3, 3)", count));
    }
  }
  if (direction && !direction->single() && direction->count() != count) {
    throw InputError({.field = "directions"}, fmt::format("has {} rows", direction->count()),
                     fmt::format("one, or {}", count));
  }
  std::vector<PoseTarget> targets;
  for (std::size_t k = 0; k < count; ++k) {
    const Eigen::Vector3d at(point.at(k, 0), point.at(k, 1), point.at(k, 2));
    if (direction) {
      targets.push_back(
          PoseTarget::at(at, Eigen::Vector3d(direction->at(k, 0), direction->at(k, 1), direction->at(k, 2))));
    } else if (rotation) {
      RigidTransform pose = RigidTransform::translate(at);
      for (std::int64_t i = 0; i < 3; ++i) {
        for (std::int64_t j = 0; j < 3; ++j) {
          pose.rotation(i, j) = rotation->data()[static_cast<std::int64_t>(k) * rotation->stride(0) +
                                                 i * rotation->stride(1) + j * rotation->stride(2)];
        }
      }
      targets.push_back(PoseTarget::at(pose));
    } else {
      targets.push_back(PoseTarget::at(at));
    }
  }
  return targets;
}

FollowedPath followed(const Machine& machine, const ArrayLike& points, const std::optional<ArrayLike>& directions,
                      const std::optional<ArrayLike>& rotations, const AxisPositions& hold, const AxisPositions& start,
                      double mm_per_radian, double largest_turn_deg) {
  PathOptions options;
  options.inverse.held = axis_positions(machine, "hold", hold);
  if (!start.empty()) {
    options.start.assign(machine.axes.size(), std::numeric_limits<double>::quiet_NaN());
    for (const HeldAxis& at : axis_positions(machine, "start", start)) options.start[at.axis] = at.position;
  }
  if (!(mm_per_radian > 0 && std::isfinite(mm_per_radian))) {
    throw InputError({.field = "mm_per_radian"}, fmt::format("is {}", mm_per_radian), "above zero");
  }
  if (!(largest_turn_deg > 0 && largest_turn_deg <= 360)) {
    throw InputError({.field = "largest_turn_deg"}, fmt::format("is {}", largest_turn_deg), "above 0, at most 360");
  }
  options.mm_per_radian = mm_per_radian;
  options.largest_turn = largest_turn_deg * kDegree;
  const std::vector<PoseTarget> targets = targets_of(points, directions, rotations);
  if (targets.empty()) throw InputError({.field = "points_mm"}, "has no points", "a path");
  FollowedPath path{machine, computed([&] { return follow_path(machine, targets, options); })};
  if (path.result.status == PathStatus::invalid_options) {
    throw InputError({.field = "machine"}, describe(machine, path.result));
  }
  return path;
}

nb::object commands(const FollowedPath& path) {
  const std::size_t axes = path.machine.axes.size(), count = path.result.solutions.size();
  std::vector<double> values;
  for (const InverseSolution& solution : path.result.solutions) {
    values.insert(values.end(), solution.position.begin(),
                  solution.position.begin() + static_cast<std::ptrdiff_t>(axes));
  }
  return array_of(std::move(values), {count, axes});
}

}  // namespace

const char* path_status_words(PathStatus status) {
  switch (status) {
    case PathStatus::not_run:
      return "not-run";
    case PathStatus::followed:
      return "followed";
    case PathStatus::outside_travel:
      return "outside-travel";
    case PathStatus::not_reached:
      return "not-reached";
    case PathStatus::start_undecided:
      return "start-undecided";
    case PathStatus::invalid_options:
      return "invalid-options";
  }
  return "";
}

const char* tool_path_status_words(ToolPathStatus status) {
  switch (status) {
    case ToolPathStatus::not_run:
      return "not-run";
    case ToolPathStatus::followed:
      return "followed";
    case ToolPathStatus::jumps_while_working:
      return "jumps-while-working";
    case ToolPathStatus::outside_travel:
      return "outside-travel";
    case ToolPathStatus::not_reached:
      return "not-reached";
    case ToolPathStatus::start_undecided:
      return "start-undecided";
    case ToolPathStatus::too_many_poses:
      return "too-many-poses";
    case ToolPathStatus::no_retract:
      return "no-retract";
    case ToolPathStatus::invalid_options:
      return "invalid-options";
  }
  return "";
}

std::vector<NamedJump> named_jumps(const Machine& machine, const std::vector<PathJump>& jumps) {
  std::vector<NamedJump> named;
  for (const PathJump& jump : jumps) named.push_back({jump, machine.axes[jump.axis].name});
  return named;
}

void bind_path_parts(nb::module_& module) {
  nb::class_<NamedJump>(
      module, "PathJump",
      "A step in which the axes move far although the tool hardly does: the branch switches, an axis\n"
      "unwinds a turn, or the path passes close by a singular pose.")
      .def_prop_ro(
          "pose", [](const NamedJump& j) { return j.jump.pose; }, "Index of the pose or step where it ends.")
      .def_ro("axis", &NamedJump::axis, "Rotary axis that turns most.")
      .def_prop_ro(
          "turn_rad", [](const NamedJump& j) { return j.jump.turn; }, "Signed.")
      .def_prop_ro("largest_linear_move_mm", [](const NamedJump& j) { return j.jump.largest_linear_move; })
      .def_prop_ro(
          "point_deviation_mm", [](const NamedJump& j) { return j.jump.point_deviation; },
          "Tool from the chord of the path when all axes are half way, mm.")
      .def_prop_ro("leaves_singular_pose", [](const NamedJump& j) { return j.jump.leaves_singular_pose; })
      .def("__repr__", [](const NamedJump& j) {
        return fmt::format("<abbe.PathJump at {}: {} turns {:.4g} deg>", j.jump.pose, j.axis, j.jump.turn / kDegree);
      });
  nb::class_<FollowedPath>(module, "FollowedPath", "Axis commands along a path of poses. Made by follow_path().")
      .def_prop_ro(
          "status", [](const FollowedPath& p) { return path_status_words(p.result.status); },
          "'followed', 'outside-travel', 'not-reached' or 'start-undecided'.")
      .def_prop_ro("positions_mm_rad", &commands, nb::sig("def positions_mm_rad(self) -> numpy.ndarray"),
                   "[n, axes] commands, mm or rad; [0, axes] where the path is not followed.")
      .def_prop_ro("jumps", [](const FollowedPath& p) { return named_jumps(p.machine, p.result.jumps); })
      .def_prop_ro(
          "length_mm", [](const FollowedPath& p) { return p.result.length; }, "Sum of the moves of all axes.")
      .def_prop_ro(
          "failed_pose",
          [](const FollowedPath& p) {
            return p.result.status == PathStatus::followed ? std::nullopt : std::optional(p.result.failed_pose);
          },
          "Index of the pose that failed; None: none did.")
      .def(
          "text", [](const FollowedPath& p) { return describe(p.machine, p.result); }, "The result in words.")
      .def("__repr__", [](const FollowedPath& p) {
        return fmt::format("<abbe.FollowedPath: {}, {} poses, {} jumps>", path_status_words(p.result.status),
                           p.result.solutions.size(), p.result.jumps.size());
      });
  module.def(
      "follow_path", &followed, nb::arg("machine"), nb::arg("points_mm"), nb::kw_only(),
      nb::arg("directions") = nb::none(), nb::arg("rotations") = nb::none(), nb::arg("hold") = AxisPositions{},
      nb::arg("start") = AxisPositions{}, nb::arg("mm_per_radian") = 100.0, nb::arg("largest_turn_deg") = 20.0,
      "Axis commands along a path of poses by continuity: the fewest jumps, then the shortest moves.\n\n"
      "points_mm [n, 3]: functional point in the workpiece frame, close enough that neighbours differ by a small "
      "turn.\n"
      "directions [n, 3] or [3]: from it to the spindle; or rotations [n, 3, 3] of the tool frame. hold: {'C_deg': "
      "30},\n"
      "axes kept at a command. start: where axes stand before the first pose. mm_per_radian: how moves of rotary axes\n"
      "count. largest_turn_deg: a larger turn in one step is a jump. Method: docs/kinematics.md.");
}

}  // namespace abbe::python
