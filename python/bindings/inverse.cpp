#include <fmt/format.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <cmath>

#include "abbe/formats/text/input_error.h"
#include "abbe/machine/inverse_kinematics.h"
#include "bindings/arrays.h"

namespace abbe::python {
namespace {

Eigen::Vector3d row(const Numbers& numbers, std::size_t k) {
  Eigen::Vector3d result;
  for (std::int64_t c = 0; c < 3; ++c) {
    result[c] = numbers.data()[static_cast<std::int64_t>(k) * numbers.stride(0) + c * numbers.stride(1)];
  }
  return result;
}

Numbers rows_of_three(const ArrayLike& argument, const char* name) {
  const Numbers numbers = argument.numbers(name);
  if (numbers.ndim() != 2 || numbers.shape(1) != 3)
    throw InputError({.field = name}, "has another shape", "shape (n, 3)");
  return numbers;
}

/// Axis commands for targets: the best solution of each.
struct Inverse {
  nb::object positions_mm_rad, solved;
  std::vector<std::string> problems;
};

Inverse inverse_of(const Machine& machine, const ArrayLike& points, const std::optional<ArrayLike>& directions,
                   const std::optional<ArrayLike>& rotations, const std::optional<ArrayLike>& start,
                   const std::map<std::string, double>& hold) {
  if (directions && rotations)
    throw InputError({.field = "rotations"}, "is given together with directions", "one of them");
  const Numbers point = rows_of_three(points, "points_mm");
  const std::size_t count = point.shape(0), axes = machine.axes.size();
  std::optional<Numbers> direction, rotation;
  if (directions) direction = rows_of_three(*directions, "directions");
  if (rotations) {
    rotation = rotations->numbers("rotations");
    if (rotation->ndim() != 3 || rotation->shape(1) != 3 || rotation->shape(2) != 3) {
      throw InputError({.field = "rotations"}, "has another shape", "shape (n, 3, 3)");
    }
  }
  if ((direction && direction->shape(0) != count) || (rotation && rotation->shape(0) != count)) {
    throw InputError({.field = direction ? "directions" : "rotations"}, "are not as many as points_mm",
                     fmt::format("{} of them", count));
  }
  InverseOptions options;
  for (const auto& [name, position] : hold) {
    const std::size_t axis = machine.find_axis(name);
    if (axis == Machine::npos) throw nb::key_error(fmt::format("no axis '{}' in {}", name, machine.chain()).c_str());
    options.held.push_back({axis, position});
  }
  const InverseKinematics inverse(machine, options);
  if (!inverse.problem().empty())
    throw InputError({.field = "machine"}, inverse.problem(), "a machine without problems()");
  std::optional<Positions> starts;
  if (start) {
    starts.emplace(*start, machine, "start_mm_rad");
    if (!starts->single() && starts->count() != count) {
      throw InputError({.field = "start_mm_rad"}, "are not as many as points_mm", fmt::format("one, or {}", count));
    }
  }
  const PoseList start_list = starts ? starts->list() : PoseList{};
  Columns<double> commands(axes, count);
  std::vector<std::uint8_t> solved(count);
  std::vector<std::string> problems(count);
  InverseResult result;
  for (std::size_t k = 0; k < count; ++k) {
    PoseTarget target = direction ? PoseTarget::at(row(point, k), row(*direction, k)) : PoseTarget::at(row(point, k));
    if (rotation) {
      RigidTransform pose = RigidTransform::translate(row(point, k));
      for (std::int64_t i = 0; i < 3; ++i) {
        for (std::int64_t j = 0; j < 3; ++j) {
          pose.rotation(i, j) = rotation->data()[static_cast<std::int64_t>(k) * rotation->stride(0) +
                                                 i * rotation->stride(1) + j * rotation->stride(2)];
        }
      }
      target = PoseTarget::at(pose);
    }
    std::vector<double> from = starts ? start_list.pose(starts->single() ? 0 : k) : std::vector<double>{};
    inverse.solve(target, starts ? from.data() : nullptr, result);
    solved[k] = result.status == InverseStatus::solved ? 1 : 0;
    if (!solved[k]) problems[k] = describe(machine, result);
    for (std::size_t i = 0; i < axes; ++i) commands[i][k] = solved[k] ? result.solutions.front().position[i] : NAN;
  }
  return {commands.release({axes}, false), array_of_bools(std::move(solved)), std::move(problems)};
}

}  // namespace

void bind_inverse(nb::module_& module) {
  nb::class_<Inverse>(module, "InverseSolutions", "Axis commands for targets.")
      .def_ro("positions_mm_rad", &Inverse::positions_mm_rad, nb::sig("def positions_mm_rad(self) -> numpy.ndarray"),
              "[n, axes] commands, mm or rad; NaN where there is no solution.")
      .def_ro("solved", &Inverse::solved, nb::sig("def solved(self) -> numpy.ndarray"), "[n] whether there is one.")
      .def_ro("problems", &Inverse::problems, "[n] why there is none, in words; empty where there is one.");
  module.def(
      "inverse", &inverse_of, nb::arg("machine"), nb::arg("points_mm"), nb::kw_only(),
      nb::arg("directions") = nb::none(), nb::arg("rotations") = nb::none(), nb::arg("start_mm_rad") = nb::none(),
      nb::arg("hold_mm_rad") = std::map<std::string, double>{},
      "Commands that bring the tool of a machine without errors to targets in the workpiece frame.\n\n"
      "points_mm [n, 3]: functional point. directions [n, 3]: from it to the spindle, of any length; or rotations\n"
      "[n, 3, 3]: columns are the axes of the tool frame. start_mm_rad [axes] or [n, axes]: the solution\n"
      "nearest to it is taken. hold_mm_rad: axes that are kept at a command. Method: docs/kinematics.md.");
}

}  // namespace abbe::python
