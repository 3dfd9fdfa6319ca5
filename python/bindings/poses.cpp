#include <fmt/format.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <vector>

#include "abbe/errors/pose_model.h"
#include "abbe/formats/text/input_error.h"
#include "bindings/arrays.h"
#include "bindings/machine_errors.h"
#include "bindings/states.h"

namespace abbe::python {
namespace {

/// Poses of the tool in the workpiece frame; arrays of NumPy.
struct Poses {
  nb::object points_mm, rotations, covered;
};

/// Where results go: each number of all poses, one number after the other.
PointArrays points(double* columns, std::size_t count) { return {columns, columns + count, columns + 2 * count}; }

PointArrays from(PointArrays arrays, std::size_t first) {
  return {arrays.x + first, arrays.y + first, arrays.z + first};
}

RotationArrays rotations(double* columns, std::size_t count) {
  RotationArrays arrays;
  for (std::size_t e = 0; e < 9; ++e) arrays.r[e] = columns + e * count;
  return arrays;
}

RotationArrays from(RotationArrays arrays, std::size_t first) {
  for (double*& element : arrays.r) element += first;
  return arrays;
}

/// Poses at which a model is asked: their commands, and the states that its errors need.
struct Asked {
  Asked(const PoseModel& model, const ArrayLike& argument, const StatesArgument& values)
      : positions(argument, model.machine()), states(values, model.machine(), model.errors(), positions.count()) {}
  /// Of a machine without errors.
  Asked(const PoseModel& model, const ArrayLike& argument)
      : positions(argument, model.machine()), states({}, model.machine(), {}, 0) {}
  Positions positions;
  GivenColumns states;
};

/// Runs work(positions of a block, its first pose) over all poses without the GIL.
template <class Work>
void for_blocks(const Asked& asked, const Work& work) {
  const Positions& positions = asked.positions;
  const auto run = [&](std::size_t first, std::size_t count, Positions::Block& memory,
                       std::vector<const double*>& columns) {
    PositionArrays block = positions.block(first, count, memory);
    block.state = asked.states.from(first, columns);
    work(block, first);
  };
  if (positions.count() <= Positions::kBlock) {
    Positions::Block memory;
    std::vector<const double*> columns;
    return run(0, positions.count(), memory, columns);
  }
  const nb::gil_scoped_release release;
  for_each_block_of(positions.count(), [&](std::size_t first, std::size_t count) {
    thread_local Positions::Block memory;
    thread_local std::vector<const double*> columns;
    run(first, count, memory, columns);
  });
}

nb::object covered_array(Columns<std::uint8_t>& covered, bool single) {
  return single ? nb::object(nb::bool_(covered[0][0] != 0)) : covered.release_bools();
}

void fill_poses(const PoseModel& model, const Asked& asked, bool nominal, double* point, double* rotation,
                std::uint8_t* covered) {
  const PointArrays to_points = points(point, asked.positions.count());
  const RotationArrays to_rotations = rotations(rotation, asked.positions.count());
  for_blocks(asked, [&](PositionArrays block, std::size_t first) {
    if (nominal) {
      model.nominal_poses(block, from(to_points, first), from(to_rotations, first));
    } else {
      model.poses(block, from(to_points, first), from(to_rotations, first), covered + first);
    }
  });
}

[[noreturn]] void refuse_out(const Positions& positions, const char* expected) {
  throw InputError({.field = "out"},
                   positions.single() ? "is given for a single pose" : "has another shape or order, or is read-only",
                   fmt::format("{} for {} commands", expected, positions.count()));
}

/// Memory of an array [n, shape...] laid out as these functions return it; null if it is no such array.
/// @param parts  from one number of a pose to the next along each dimension of the shape, in numbers of a pose
/// @throws InputError if it overlaps the commands, which would be written over before they are read
double* memory_of_columns(nb::handle array, const Positions& positions, std::initializer_list<std::size_t> shape,
                          std::initializer_list<std::size_t> parts) {
  const std::size_t count = positions.count();
  std::vector<std::size_t> sizes{count};
  std::vector<std::int64_t> steps{1};
  sizes.insert(sizes.end(), shape);
  for (const std::size_t part : parts) steps.push_back(static_cast<std::int64_t>(part * count));
  auto* const memory = static_cast<double*>(memory_of(array, NumberType::float64, sizes, steps));
  std::size_t size = 1;
  for (const std::size_t n : sizes) size *= n;
  if (memory && positions.overlaps(memory, size)) {
    throw InputError({.field = "out"}, "shares memory with positions_mm_rad", "memory of its own");
  }
  return memory;
}

void fill_out(const PoseModel& model, const Asked& asked, bool nominal, const Poses& out) {
  const Positions& positions = asked.positions;
  const std::size_t count = positions.count();
  const std::int64_t one = 1;
  double* point = memory_of_columns(out.points_mm, positions, {3}, {1});
  double* rotation = memory_of_columns(out.rotations, positions, {3, 3}, {3, 1});
  void* covered = nominal ? nullptr : memory_of(out.covered, NumberType::bool8, {&count, 1}, {&one, 1});
  const bool has_coverage = nominal ? out.covered.is_none() : covered != nullptr;
  if (positions.single() || !point || !rotation || !has_coverage) {
    refuse_out(positions, nominal ? "a result of nominal_poses()" : "a result of poses()");
  }
  fill_poses(model, asked, nominal, point, rotation, static_cast<std::uint8_t*>(covered));
}

nb::object poses_of(const PoseModel& model, const Asked& asked, bool nominal, Poses* out) {
  const Positions& positions = asked.positions;
  if (out) {
    fill_out(model, asked, nominal, *out);
    return nb::find(out);
  }
  Columns<double> point(3, positions.count()), rotation(9, positions.count());
  Columns<std::uint8_t> covered(1, positions.count());
  fill_poses(model, asked, nominal, point[0], rotation[0], covered[0]);
  const bool single = positions.single();
  Poses result;
  result.points_mm = point.release({3}, single);
  result.rotations = rotation.release({3, 3}, single);
  result.covered = nominal ? nb::none() : covered_array(covered, single);
  return nb::cast(std::move(result));
}

nb::object pose_points(const PoseModel& model, const Asked& asked, const std::optional<ArrayLike>& out) {
  const Positions& positions = asked.positions;
  const auto fill = [&](PointArrays to) {
    for_blocks(asked, [&](PositionArrays block, std::size_t first) { model.poses(block, from(to, first)); });
  };
  if (out) {
    double* memory = memory_of_columns(out->source, positions, {3}, {1});
    if (!memory || positions.single()) refuse_out(positions, "an array (n, 3) of float64 in Fortran order");
    fill(points(memory, positions.count()));
    return nb::borrow(out->source);
  }
  Columns<double> point(3, positions.count());
  fill(points(point[0], positions.count()));
  return point.release({3}, positions.single());
}

nb::object deviations_of(const PoseModel& model, const Asked& asked) {
  const Positions& positions = asked.positions;
  Columns<double> deviation(6, positions.count());
  for_blocks(asked, [&](PositionArrays block, std::size_t first) {
    std::array<double*, 6> out{};
    for (std::size_t r = 0; r < 6; ++r) out[r] = deviation[r] + first;
    model.deviations(block, out.data());
  });
  return deviation.release({6}, positions.single());
}

nb::object covered_of(const PoseModel& model, const Asked& asked) {
  const Positions& positions = asked.positions;
  Columns<double> point(3, positions.count());
  Columns<std::uint8_t> covered(1, positions.count());
  const PointArrays to = points(point[0], positions.count());
  for_blocks(asked, [&](PositionArrays block, std::size_t first) {
    model.poses(block, from(to, first), {}, covered[0] + first);
  });
  return covered_array(covered, positions.single());
}

nb::object jacobian_of(const PoseModel& model, const Asked& asked, bool by_commands) {
  const Positions& positions = asked.positions;
  const std::size_t columns = by_commands ? model.machine().axes.size() : model.errors().parameter_count();
  constexpr std::size_t kLargest = std::size_t{1} << 31;  // numbers: 16 GiB
  if (positions.count() * 6 * columns > kLargest) {
    throw InputError({.field = "positions_mm_rad"},
                     fmt::format("{} poses with {} derivatives each", positions.count(), 6 * columns),
                     "fewer poses in one call: the derivatives would take more than 16 GiB");
  }
  std::vector<double> jacobian(positions.count() * 6 * columns);
  for_blocks(asked, [&](PositionArrays block, std::size_t first) {
    double* out = jacobian.data() + first * 6 * columns;
    by_commands ? model.jacobian_by_positions(block, out) : model.jacobian(block, out);
  });
  if (positions.single()) return array_of(std::move(jacobian), {6, columns});
  return array_of(std::move(jacobian), {positions.count(), 6, columns});
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
          "poses",
          [](const PoseModel& model, const ArrayLike& positions, const StatesArgument& states, Poses* out) {
            return poses_of(model, {model, positions, states}, false, out);
          },
          nb::arg("positions_mm_rad"), nb::kw_only(), nb::arg("states") = nb::none(),
          nb::arg("out").none() = nb::none(),
          nb::sig("def poses(self, positions_mm_rad: numpy.typing.ArrayLike, *, states: dict[str, "
                  "numpy.typing.ArrayLike] | None = None, out: Poses | None = None) -> Poses"),
          "Where the tool really is.\n\n"
          "states: values of states that the errors depend on, by column: {'ambient_degC': number or [n]}; sides of\n"
          "approach by the name of the state, -1 or 1.\n"
          "out: the result of an earlier call with as many commands, which is overwritten and returned: new memory\n"
          "for a million poses takes about as long as computing them. It must not share memory with the commands.\n"
          "If the call fails, part of it may be overwritten.")
      .def(
          "nominal_poses",
          [](const PoseModel& model, const ArrayLike& positions, Poses* out) {
            return poses_of(model, {model, positions}, true, out);
          },
          nb::arg("positions_mm_rad"), nb::kw_only(), nb::arg("out").none() = nb::none(),
          nb::sig("def nominal_poses(self, positions_mm_rad: numpy.typing.ArrayLike, *, out: Poses | None = None) -> "
                  "Poses"),
          "Where the tool would be without errors. out: as in poses().")
      .def(
          "points",
          [](const PoseModel& model, const ArrayLike& positions, const StatesArgument& states,
             const std::optional<ArrayLike>& out) {
            return pose_points(model, {model, positions, states}, out);
          },
          nb::arg("positions_mm_rad"), nb::kw_only(), nb::arg("states") = nb::none(), nb::arg("out") = nb::none(),
          nb::sig("def points(self, positions_mm_rad: numpy.typing.ArrayLike, *, states: dict[str, "
                  "numpy.typing.ArrayLike] | None = None, out: numpy.ndarray | None = None) -> numpy.ndarray"),
          "The functional point alone, [n, 3], mm: faster than poses(). states: as in poses().\n\n"
          "out: an array (n, 3) of float64 in Fortran order, such as an earlier result, which is overwritten and\n"
          "returned. It must not share memory with the commands.")
      .def(
          "covered",
          [](const PoseModel& model, const ArrayLike& positions, const StatesArgument& states) {
            return covered_of(model, {model, positions, states});
          },
          nb::arg("positions_mm_rad"), nb::kw_only(), nb::arg("states") = nb::none(),
          nb::sig("def covered(self, positions_mm_rad: numpy.typing.ArrayLike, *, states: dict[str, "
                  "numpy.typing.ArrayLike] | None = None) -> numpy.ndarray | bool"),
          "[n] false where a command lies outside the range of an error motion.")
      .def(
          "deviations",
          [](const PoseModel& model, const ArrayLike& positions, const StatesArgument& states) {
            return deviations_of(model, {model, positions, states});
          },
          nb::arg("positions_mm_rad"), nb::kw_only(), nb::arg("states") = nb::none(),
          nb::sig("def deviations(self, positions_mm_rad: numpy.typing.ArrayLike, *, states: dict[str, "
                  "numpy.typing.ArrayLike] | None = None) -> numpy.ndarray"),
          "Actual minus nominal, [n, 6]: displacement x y z in mm, rotation vector x y z in rad, workpiece frame.")
      .def(
          "jacobian",
          [](const PoseModel& model, const ArrayLike& positions, const StatesArgument& states) {
            return jacobian_of(model, {model, positions, states}, false);
          },
          nb::arg("positions_mm_rad"), nb::kw_only(), nb::arg("states") = nb::none(),
          nb::sig("def jacobian(self, positions_mm_rad: numpy.typing.ArrayLike, *, states: dict[str, "
                  "numpy.typing.ArrayLike] | None = None) -> numpy.ndarray"),
          "Derivative of the deviations by the values of the errors, [n, 6, p], per mm or rad.")
      .def(
          "jacobian_by_positions",
          [](const PoseModel& model, const ArrayLike& positions, const StatesArgument& states) {
            return jacobian_of(model, {model, positions, states}, true);
          },
          nb::arg("positions_mm_rad"), nb::kw_only(), nb::arg("states") = nb::none(),
          nb::sig("def jacobian_by_positions(self, positions_mm_rad: numpy.typing.ArrayLike, *, states: dict[str, "
                  "numpy.typing.ArrayLike] | None = None) -> numpy.ndarray"),
          "Derivative of the actual pose by the commands, [n, 6, axes], per mm or rad.");
  module.def(
      "nominal_poses",
      [](const Machine& machine, const ArrayLike& positions) {
        const PoseModel model(machine, {});
        return poses_of(model, {model, positions}, true, nullptr);
      },
      nb::arg("machine"), nb::arg("positions_mm_rad"),
      nb::sig("def nominal_poses(machine: Machine, positions_mm_rad: numpy.typing.ArrayLike) -> Poses"),
      "Poses of a machine without errors.");
}

}  // namespace abbe::python
