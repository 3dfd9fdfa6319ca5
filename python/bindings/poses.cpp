#include <fmt/format.h>
#include <nanobind/eigen/dense.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <cmath>

#include "abbe/errors/pose_model.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/machine/inverse_kinematics.h"
#include "bindings/arrays.h"
#include "bindings/machine_errors.h"

namespace abbe::python {
namespace {

/// Poses of the tool in the workpiece frame; arrays of NumPy.
struct Poses {
  nb::object points_mm, rotations, covered;
};

PointArrays points(Columns<double>& columns) { return {columns[0], columns[1], columns[2]}; }

PointArrays from(PointArrays arrays, std::size_t first) {
  return {arrays.x + first, arrays.y + first, arrays.z + first};
}

RotationArrays rotations(Columns<double>& columns) {
  RotationArrays arrays;
  for (std::size_t e = 0; e < 9; ++e) arrays.r[e] = columns[e];
  return arrays;
}

RotationArrays from(RotationArrays arrays, std::size_t first) {
  for (double*& element : arrays.r) element += first;
  return arrays;
}

/// Runs work(positions of a block, its first pose) over all poses without the GIL.
template <class Work>
void for_blocks(const Positions& positions, const Work& work) {
  if (positions.count() <= Positions::kBlock) {
    Positions::Block memory;
    return work(positions.block(0, positions.count(), memory), std::size_t{0});
  }
  const nb::gil_scoped_release release;
  for_each_block_of(positions.count(), [&](std::size_t first, std::size_t count) {
    thread_local Positions::Block memory;
    work(positions.block(first, count, memory), first);
  });
}

nb::object covered_array(Columns<std::uint8_t>& covered, bool single) {
  nb::object bytes = covered.release({}, single);
  return single ? nb::object(nb::bool_(nb::cast<int>(bytes.attr("item")()) != 0)) : bytes.attr("view")("bool");
}

Poses poses_of(const PoseModel& model, const ArrayLike& argument, bool nominal) {
  const Positions positions(argument, model.machine());
  Columns<double> point(3, positions.count()), rotation(9, positions.count());
  Columns<std::uint8_t> covered(1, positions.count());
  for_blocks(positions, [&](PositionArrays block, std::size_t first) {
    if (nominal) {
      model.nominal_poses(block, from(points(point), first), from(rotations(rotation), first));
    } else {
      model.poses(block, from(points(point), first), from(rotations(rotation), first), covered[0] + first);
    }
  });
  const bool single = positions.single();
  Poses result;
  result.points_mm = point.release({3}, single);
  result.rotations = rotation.release({3, 3}, single);
  result.covered = nominal ? nb::none() : covered_array(covered, single);
  return result;
}

nb::object points_of(const PoseModel& model, const ArrayLike& argument) {
  const Positions positions(argument, model.machine());
  Columns<double> point(3, positions.count());
  for_blocks(positions,
             [&](PositionArrays block, std::size_t first) { model.poses(block, from(points(point), first)); });
  return point.release({3}, positions.single());
}

nb::object deviations_of(const PoseModel& model, const ArrayLike& argument) {
  const Positions positions(argument, model.machine());
  Columns<double> deviation(6, positions.count());
  for_blocks(positions, [&](PositionArrays block, std::size_t first) {
    std::array<double*, 6> out{};
    for (std::size_t r = 0; r < 6; ++r) out[r] = deviation[r] + first;
    model.deviations(block, out.data());
  });
  return deviation.release({6}, positions.single());
}

nb::object covered_of(const PoseModel& model, const ArrayLike& argument) {
  const Positions positions(argument, model.machine());
  Columns<double> point(3, positions.count());
  Columns<std::uint8_t> covered(1, positions.count());
  for_blocks(positions, [&](PositionArrays block, std::size_t first) {
    model.poses(block, from(points(point), first), {}, covered[0] + first);
  });
  return covered_array(covered, positions.single());
}

nb::object jacobian_of(const PoseModel& model, const ArrayLike& argument, bool by_commands) {
  const Positions positions(argument, model.machine());
  const std::size_t columns = by_commands ? model.machine().axes.size() : model.errors().parameter_count();
  constexpr std::size_t kLargest = std::size_t{1} << 31;  // numbers: 16 GiB
  if (positions.count() * 6 * columns > kLargest) {
    throw InputError({.field = "positions_mm_rad"},
                     fmt::format("{} poses with {} derivatives each", positions.count(), 6 * columns),
                     "fewer poses in one call: the derivatives would take more than 16 GiB");
  }
  std::vector<double> jacobian(positions.count() * 6 * columns);
  for_blocks(positions, [&](PositionArrays block, std::size_t first) {
    double* out = jacobian.data() + first * 6 * columns;
    by_commands ? model.jacobian_by_positions(block, out) : model.jacobian(block, out);
  });
  if (positions.single()) return array_of(std::move(jacobian), {6, columns});
  return array_of(std::move(jacobian), {positions.count(), 6, columns});
}

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

void bind_poses(nb::module_& module) {
  nb::class_<Poses>(module, "Poses", "Poses of the functional point and the tool frame in the workpiece frame.")
      .def_ro("points_mm", &Poses::points_mm, nb::sig("def points_mm(self) -> numpy.ndarray"),
              "[n, 3] functional point, mm; [3] for a single pose.")
      .def_ro("rotations", &Poses::rotations, nb::sig("def rotations(self) -> numpy.ndarray"),
              "[n, 3, 3] columns are the axes of the tool frame; [3, 3] for a single pose.")
      .def_ro("covered", &Poses::covered, nb::sig("def covered(self) -> numpy.ndarray | bool | None"),
              "[n] false where a command lies outside the range of an error motion, so that the pose is an\n"
              "extrapolation; None for nominal poses.")
      .def("__repr__", [](const Poses& poses) {
        const nb::object shape = poses.points_mm.attr("shape");
        return fmt::format("<abbe.Poses, points_mm of shape {}>", nb::str(shape).c_str());
      });
  nb::class_<Inverse>(module, "InverseSolutions", "Axis commands for targets.")
      .def_ro("positions_mm_rad", &Inverse::positions_mm_rad, nb::sig("def positions_mm_rad(self) -> numpy.ndarray"),
              "[n, axes] commands, mm or rad; NaN where there is no solution.")
      .def_ro("solved", &Inverse::solved, nb::sig("def solved(self) -> numpy.ndarray"), "[n] whether there is one.")
      .def_ro("problems", &Inverse::problems, "[n] why there is none, in words; empty where there is one.");
  nb::class_<PoseModel>(
      module, "PoseModel",
      "Poses of a machine with errors, compiled for many commands.\n\n"
      "Commands are arrays [n, axes] or [axes] in the order of the chain, mm for linear and rad for rotary axes. "
      "Arrays in\n"
      "Fortran order are used without a copy. Machine and errors are copied. Reversal values are not applied.\n\n"
      ">>> import abbe\n"
      ">>> mill = abbe.Machine.from_chain(\"w X' Y' b Z t\")\n"
      ">>> errors = abbe.Errors(mill)\n"
      ">>> errors.add_location('EC0Y', value_urad=20)\n"
      ">>> abbe.PoseModel(errors).deviations([[0, 200, 0]])[:, :2].round(6).tolist()\n"
      "[[-0.004, -0.0]]\n"
      "\nSource: ISO 230-1:2012, 3.4; composition in docs/conventions.md.")
      .def(
          "__init__",
          [](PoseModel* self, const MachineErrors& errors) { new (self) PoseModel(errors.machine, errors.set()); },
          nb::arg("errors"))
      .def(
          "poses", [](const PoseModel& model, const ArrayLike& positions) { return poses_of(model, positions, false); },
          nb::arg("positions_mm_rad"), "Where the tool really is.")
      .def(
          "nominal_poses",
          [](const PoseModel& model, const ArrayLike& positions) { return poses_of(model, positions, true); },
          nb::arg("positions_mm_rad"), "Where the tool would be without errors.")
      .def("points", &points_of, nb::arg("positions_mm_rad"),
           nb::sig("def points(self, positions_mm_rad: numpy.typing.ArrayLike) -> numpy.ndarray"),
           "The functional point alone, [n, 3], mm: faster than poses().")
      .def("covered", &covered_of, nb::arg("positions_mm_rad"),
           nb::sig("def covered(self, positions_mm_rad: numpy.typing.ArrayLike) -> numpy.ndarray | bool"),
           "[n] false where a command lies outside the range of an error motion.")
      .def("deviations", &deviations_of, nb::arg("positions_mm_rad"),
           nb::sig("def deviations(self, positions_mm_rad: numpy.typing.ArrayLike) -> numpy.ndarray"),
           "Actual minus nominal, [n, 6]: displacement x y z in mm, rotation vector x y z in rad, workpiece frame.")
      .def(
          "jacobian",
          [](const PoseModel& model, const ArrayLike& positions) { return jacobian_of(model, positions, false); },
          nb::arg("positions_mm_rad"),
          nb::sig("def jacobian(self, positions_mm_rad: numpy.typing.ArrayLike) -> numpy.ndarray"),
          "Derivative of the deviations by the values of the errors, [n, 6, p], per mm or rad.")
      .def(
          "jacobian_by_positions",
          [](const PoseModel& model, const ArrayLike& positions) { return jacobian_of(model, positions, true); },
          nb::arg("positions_mm_rad"),
          nb::sig("def jacobian_by_positions(self, positions_mm_rad: numpy.typing.ArrayLike) -> numpy.ndarray"),
          "Derivative of the actual pose by the commands, [n, 6, axes], per mm or rad.");
  module.def(
      "nominal_poses",
      [](const Machine& machine, const ArrayLike& positions) {
        return poses_of(PoseModel(machine, {}), positions, true);
      },
      nb::arg("machine"), nb::arg("positions_mm_rad"), "Poses of a machine without errors.");
  module.def(
      "inverse", &inverse_of, nb::arg("machine"), nb::arg("points_mm"), nb::kw_only(),
      nb::arg("directions") = nb::none(), nb::arg("rotations") = nb::none(), nb::arg("start_mm_rad") = nb::none(),
      nb::arg("hold_mm_rad") = std::map<std::string, double>{},
      "Commands that bring the tool of a machine without errors to targets in the workpiece frame.\n\n"
      "points_mm [n, 3]: functional point. directions [n, 3]: from it to the spindle, of any length; or rotations\n"
      "[n, 3, 3]: columns are the axes of the tool frame. start_mm_rad [axes] or [n, axes]: the solution nearest to "
      "it\n"
      "is taken. hold_mm_rad: axes that are kept at a command. Method: docs/kinematics.md.");
}

}  // namespace abbe::python
