#include <fmt/format.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <numbers>

#include "abbe/compensate/compensated_inverse.h"
#include "abbe/formats/text/input_error.h"
#include "bindings/arrays.h"
#include "bindings/machine_errors.h"
#include "bindings/states.h"

namespace abbe::python {
namespace {

/// The inverse with the machine whose commands it takes.
struct MachineInverse {
  Machine machine;
  CompensatedInverse inverse;
  TargetKind target;
};

struct Corrections {
  nb::object positions_mm_rad, reached, status, position_residual_mm, orientation_residual_rad;
};

TargetKind target_kind(const std::string& word) {
  if (word == "point") return TargetKind::point;
  if (word == "direction") return TargetKind::point_and_direction;
  if (word == "pose") return TargetKind::full_pose;
  throw InputError({.field = "target"}, fmt::format("'{}' is no target", word), "'point', 'direction' or 'pose'");
}

MachineInverse make_inverse(const MachineErrors& errors, const std::string& target, double largest_turn_deg,
                            double largest_shift_mm, const std::vector<std::string>& hold) {
  if (!(largest_turn_deg > 0 && largest_turn_deg <= 10)) {
    throw InputError({.field = "largest_turn_deg"}, fmt::format("is {}", largest_turn_deg),
                     "above 0, at most 10 degrees");
  }
  if (!(largest_shift_mm > 0)) throw InputError({.field = "largest_shift_mm"}, "is not above zero", "a length in mm");
  std::vector<std::size_t> held;
  for (const std::string& name : hold) {
    held.push_back(errors.machine.find_axis(name));
    if (held.back() == Machine::npos) {
      throw nb::key_error(fmt::format("no axis '{}' in {}", name, errors.machine.chain()).c_str());
    }
  }
  require_no_given_states(errors);
  CorrectionOptions options;
  options.target = target_kind(target);
  options.largest_turn = largest_turn_deg * std::numbers::pi / 180;
  options.largest_shift = largest_shift_mm;
  MachineInverse made{errors.machine, CompensatedInverse(errors.machine, errors.set(), options, held), options.target};
  if (!made.inverse.problem().empty()) {
    throw InputError({.field = "errors"}, made.inverse.problem(), "errors and axes that can be corrected");
  }
  return made;
}

Corrections corrected(const MachineInverse& self, const Positions& positions,
                      const std::function<void(PositionArrays, std::size_t first, const CorrectedArrays&)>& work) {
  const std::size_t axes = self.machine.axes.size(), count = positions.count();
  Columns<double> commands(axes, count), position_residual(1, count), orientation_residual(1, count);
  Columns<std::uint8_t> status(1, count);
  {
    const nb::gil_scoped_release release;
    for_each_block_of(count, [&](std::size_t first, std::size_t number) {
      thread_local Positions::Block memory;
      std::array<double*, kMaxAxes> out{};
      std::array<CorrectionStatus, Positions::kBlock> became;
      for (std::size_t i = 0; i < axes; ++i) out[i] = commands[i] + first;
      work(positions.block(first, number, memory), first,
           {{out.data(), axes}, became.data(), position_residual[0] + first, orientation_residual[0] + first});
      for (std::size_t k = 0; k < number; ++k) status[0][first + k] = static_cast<std::uint8_t>(became[k]);
    });
  }
  std::vector<std::uint8_t> reached(count);
  for (std::size_t k = 0; k < count; ++k)
    reached[k] = reaches_point(static_cast<CorrectionStatus>(status[0][k])) ? 1 : 0;
  const bool single = positions.single();
  // Of a single pose: its number, not an array of one.
  const auto element = [&](const nb::object& array) -> nb::object { return single ? array.attr("item")(0) : array; };
  Corrections result;
  result.positions_mm_rad = commands.release({axes}, single);
  result.reached = element(array_of_bools(std::move(reached)));
  result.status = element(status.release({}, false));
  result.position_residual_mm = element(position_residual.release({}, false));
  result.orientation_residual_rad = element(orientation_residual.release({}, false));
  return result;
}

Corrections correct(const MachineInverse& self, const ArrayLike& argument) {
  const Positions positions(argument, self.machine);
  return corrected(self, positions, [&](PositionArrays block, std::size_t, const CorrectedArrays& out) {
    self.inverse.correct(block, out);
  });
}

/// Column pointers of an argument [n, parts...], copied number after number.
std::vector<double> columns_of(const ArrayLike& argument, const char* name, std::size_t count, std::size_t parts) {
  const Numbers numbers = argument.numbers(name);
  const bool matrix = parts == 9;
  if (numbers.ndim() != (matrix ? 3U : 2U) || numbers.shape(0) != count || numbers.shape(1) != 3 ||
      (matrix && numbers.shape(2) != 3)) {
    throw InputError({.field = name}, "has another shape", fmt::format("shape ({}, 3{})", count, matrix ? ", 3" : ""));
  }
  std::vector<double> result(parts * count);
  for (std::size_t k = 0; k < count; ++k) {
    for (std::size_t p = 0; p < parts; ++p) {
      const auto i = static_cast<std::int64_t>(matrix ? p / 3 : p);
      std::int64_t at = static_cast<std::int64_t>(k) * numbers.stride(0) + i * numbers.stride(1);
      if (matrix) at += static_cast<std::int64_t>(p % 3) * numbers.stride(2);
      result[p * count + k] = numbers.data()[at];
    }
  }
  return result;
}

Corrections reach(const MachineInverse& self, const ArrayLike& start, const ArrayLike& points,
                  const std::optional<ArrayLike>& directions, const std::optional<ArrayLike>& rotations) {
  const Positions positions(start, self.machine, "start_mm_rad");
  if (positions.single()) throw InputError({.field = "start_mm_rad"}, "is a single pose", "shape (n, axes)");
  const std::size_t count = positions.count();
  const auto require = [](bool there, bool wanted, const char* name) {
    if (there != wanted) {
      throw InputError({.field = name}, there ? "is not what this target asks for" : "is missing",
                       "directions for the target 'direction', rotations for 'pose', neither for 'point'");
    }
  };
  require(directions.has_value(), self.target == TargetKind::point_and_direction, "directions");
  require(rotations.has_value(), self.target == TargetKind::full_pose, "rotations");
  const std::vector<double> point = columns_of(points, "points_mm", count, 3);
  std::vector<double> direction, rotation;
  if (directions) direction = columns_of(*directions, "directions", count, 3);
  if (rotations) rotation = columns_of(*rotations, "rotations", count, 9);
  return corrected(self, positions, [&](PositionArrays block, std::size_t first, const CorrectedArrays& out) {
    const auto arrays = [&](const std::vector<double>& values) -> ConstPointArrays {
      if (values.empty()) return {};
      return {values.data() + first, values.data() + count + first, values.data() + 2 * count + first};
    };
    TargetArrays targets{arrays(point), arrays(direction), {}};
    for (std::size_t e = 0; e < 9 && !rotation.empty(); ++e) targets.rotation[e] = rotation.data() + e * count + first;
    self.inverse.reach(block, targets, out);
  });
}

}  // namespace

void bind_compensation(nb::module_& module) {
  nb::class_<Corrections>(module, "Corrections", "Corrected axis commands, and what is left.")
      .def_ro("positions_mm_rad", &Corrections::positions_mm_rad,
              nb::sig("def positions_mm_rad(self) -> numpy.ndarray"), "[n, axes] commands, mm or rad.")
      .def_ro("reached", &Corrections::reached, nb::sig("def reached(self) -> numpy.ndarray | bool"),
              "[n] whether the point is where it is wanted.")
      .def_ro("status", &Corrections::status, nb::sig("def status(self) -> numpy.ndarray | int"),
              "[n] index into CORRECTION_STATUSES.")
      .def_ro("position_residual_mm", &Corrections::position_residual_mm,
              nb::sig("def position_residual_mm(self) -> numpy.ndarray | float"), "[n] mm; NaN where not computed.")
      .def_ro("orientation_residual_rad", &Corrections::orientation_residual_rad,
              nb::sig("def orientation_residual_rad(self) -> numpy.ndarray | float"),
              "[n] rad; NaN where not computed.");
  std::vector<std::string> statuses;
  for (std::size_t i = 0; i < kCorrectionStatuses; ++i) {
    statuses.emplace_back(correction_status_text(static_cast<CorrectionStatus>(i)));
  }
  module.attr("CORRECTION_STATUSES") = nb::tuple(nb::cast(statuses));
  nb::class_<MachineInverse>(
      module, "CompensatedInverse",
      "Axis commands that bring the actual tool of a machine with errors to where it is wanted.\n\n"
      "target: 'point', 'direction' (point and direction of the tool) or 'pose'. Near a singularity the rotary axes "
      "turn by at\n"
      "most largest_turn_deg, and a part of the orientation error stays. hold: names of axes that keep their command.\n"
      "Method and status: docs/compensation.md.\n\n"
      ">>> import abbe\n"
      ">>> mill = abbe.Machine.from_chain(\"w X' Y' b Z t\")\n"
      ">>> errors = abbe.Errors(mill)\n"
      ">>> errors.add_location('EC0Y', value_urad=20)\n"
      ">>> abbe.CompensatedInverse(errors).correct([[100, 100, 0]]).positions_mm_rad.round(4).tolist()\n"
      "[[100.002, 100.0, 0.0]]\n")
      .def(
          "__init__",
          [](MachineInverse* self, const MachineErrors& errors, const std::string& target, double turn, double shift,
             const std::vector<std::string>& hold) {
            new (self) MachineInverse(make_inverse(errors, target, turn, shift, hold));
          },
          nb::arg("errors"), nb::kw_only(), nb::arg("target") = "direction", nb::arg("largest_turn_deg") = 0.5,
          nb::arg("largest_shift_mm") = 10.0, nb::arg("hold") = std::vector<std::string>{})
      .def("correct", &correct, nb::arg("positions_mm_rad"),
           "Commands at which the actual tool is where the nominal machine has it at these.")
      .def("reach", &reach, nb::arg("start_mm_rad"), nb::arg("points_mm"), nb::kw_only(),
           nb::arg("directions") = nb::none(), nb::arg("rotations") = nb::none(),
           "Commands at which the actual tool is at targets in the workpiece frame, from commands near by, [n, axes].");
}

}  // namespace abbe::python
