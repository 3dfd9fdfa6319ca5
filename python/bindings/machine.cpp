#include "abbe/machine/machine.h"

#include <fmt/format.h>
#include <nanobind/eigen/dense.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <tuple>

#include "abbe/formats/files/results_folder.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/machine/chain.h"
#include "abbe/machine/machine_check.h"
#include "bindings/arrays.h"
#include "bindings/files.h"
#include "bindings/states.h"

namespace abbe::python {
namespace {

Machine machine_of_chain(const std::string& chain) {
  const ParsedChain parsed = parse_chain(chain);
  if (!parsed.ok) throw InputError({.field = "chain"}, parsed.error.message(), parsed.error.pointed(chain));
  return parsed.machine;
}

std::pair<double, double> travel(const Axis& axis, AxisKind kind, double unit) {
  if (axis.kind != kind) {
    throw nb::attribute_error(axis.kind == AxisKind::linear ? "the travel of a linear axis is travel_mm"
                                                            : "the travel of a rotary axis is travel_deg");
  }
  return {axis.travel_min / unit, axis.travel_max / unit};
}

void set_travel(Axis& axis, AxisKind kind, double unit, const std::pair<double, double>& limits) {
  travel(axis, kind, unit);
  axis.travel_min = limits.first * unit;
  axis.travel_max = limits.second * unit;
}

Eigen::Matrix4d matrix(const RigidTransform& transform) {
  Eigen::Matrix4d result = Eigen::Matrix4d::Identity();
  result.topLeftCorner<3, 3>() = transform.rotation;
  result.topRightCorner<3, 1>() = transform.translation;
  return result;
}

RigidTransform transform_of(const ArrayLike& argument, const char* name) {
  const Numbers array = argument.numbers(name);
  if (array.ndim() != 2 || array.shape(0) != 4 || array.shape(1) != 4) {
    throw InputError({.field = name}, "has another shape", "a matrix of shape (4, 4), mm");
  }
  const auto at = [&](std::int64_t i, std::int64_t j) {
    return array.data()[i * array.stride(0) + j * array.stride(1)];
  };
  RigidTransform result;
  for (Eigen::Index i = 0; i < 3; ++i) {
    for (Eigen::Index j = 0; j < 3; ++j) result.rotation(i, j) = at(i, j);
    result.translation[i] = at(i, 3);
  }
  if (at(3, 0) != 0 || at(3, 1) != 0 || at(3, 2) != 0 || at(3, 3) != 1) {
    throw InputError({.field = name}, "its last row is not 0 0 0 1", "a rigid transform, mm");
  }
  return result;
}

Axis& axis_named(Machine& machine, const std::string& name) {
  const std::size_t index = machine.find_axis(name);
  if (index == Machine::npos) {
    throw nb::key_error(fmt::format("no axis '{}' in {}", name, machine.chain()).c_str());
  }
  return machine.axes[index];
}

using NamedCouplings = std::vector<std::tuple<std::string, std::string, double>>;

NamedCouplings couplings(const Machine& machine) {
  NamedCouplings named;
  for (const AxisCoupling& coupling : machine.couplings) {
    named.emplace_back(machine.axes[coupling.axis].name, machine.axes[coupling.of].name, coupling.ratio);
  }
  return named;
}

void set_couplings(Machine& machine, const NamedCouplings& named) {
  std::vector<AxisCoupling> found;
  for (const auto& [axis, of, ratio] : named) {
    axis_named(machine, axis);
    axis_named(machine, of);
    found.push_back({machine.find_axis(axis), machine.find_axis(of), ratio});
  }
  machine.couplings = std::move(found);
}

std::vector<std::string> problems(const Machine& machine) {
  std::vector<std::string> words;
  for (const MachineProblem& problem : find_problems(machine)) words.push_back(problem.text());
  return words;
}

void bind_axis(nb::module_& module) {
  nb::class_<Axis>(module, "Axis",
                   "One axis of a machine, described in the machine frame with every axis at zero.\n\n"
                   "Attributes can be set; Machine.problems() says whether the machine still makes sense.")
      .def_ro("name", &Axis::name, "ISO 841 letter and optional number: 'X', 'C', 'C2'.")
      .def_prop_ro(
          "kind", [](const Axis& axis) { return axis.kind == AxisKind::linear ? "linear" : "rotary"; },
          "'linear' or 'rotary'.")
      .def_prop_ro(
          "side", [](const Axis& axis) { return axis.side == ChainSide::workpiece ? "workpiece" : "tool"; },
          "Which side of the bed the axis carries: 'workpiece' or 'tool'.")
      .def_rw("primed", &Axis::primed, "Whether a positive command moves what the axis carries the other way.")
      .def_prop_rw(
          "direction", [](const Axis& axis) { return axis.direction; },
          [](Axis& axis, const Triple& value) { axis.direction = vector(value); },
          "Unit vector of positive motion of an unprimed axis, shape (3,).")
      .def_prop_rw(
          "point_mm", [](const Axis& axis) { return axis.point; },
          [](Axis& axis, const Triple& value) { axis.point = vector(value); },
          "Rotary: a point on the axis; linear: reference point of its error motions. Shape (3,), mm.")
      .def_prop_rw(
          "travel_mm", [](const Axis& axis) { return travel(axis, AxisKind::linear, 1); },
          [](Axis& axis, std::pair<double, double> limits) { set_travel(axis, AxisKind::linear, 1, limits); },
          "Smallest and largest command of a linear axis, mm.")
      .def_prop_rw(
          "travel_deg", [](const Axis& axis) { return travel(axis, AxisKind::rotary, kDegree); },
          [](Axis& axis, std::pair<double, double> limits) { set_travel(axis, AxisKind::rotary, kDegree, limits); },
          "Smallest and largest command of a rotary axis, degrees.")
      .def_rw("endless", &Axis::endless, "Rotary axis without limits of travel.")
      .def_rw("setting", &Axis::setting, "Positioned beforehand and not interpolated with the others.")
      .def("__repr__", [](const Axis& axis) {
        const bool linear = axis.kind == AxisKind::linear;
        const double unit = linear ? 1 : kDegree;
        return fmt::format("<abbe.Axis {}: {}, {} side, {:.9g} to {:.9g} {}{}>", axis.name,
                           linear ? "linear" : "rotary", axis.side == ChainSide::workpiece ? "workpiece" : "tool",
                           axis.travel_min / unit, axis.travel_max / unit, linear ? "mm" : "deg",
                           axis.endless ? ", endless" : "");
      });
}

}  // namespace

void bind_machine(nb::module_& module) {
  bind_axis(module);
  nb::class_<Machine> bound(
      module, "Machine",
      "A serial machine from the workpiece to the tool, without errors.\n\n"
      "Machine frame: fixed to the bed, right-handed, axes X Y Z of ISO 841. All directions and points "
      "are given in it with\n"
      "every axis at zero. Arrays of axis commands are in the order of the chain, mm for linear and "
      "rad for rotary axes.\n\n"
      ">>> import abbe\n"
      ">>> mill = abbe.Machine.from_chain(\"w C' A' Y' b X Z t\")\n"
      ">>> mill.axis_names\n"
      "['C', 'A', 'Y', 'X', 'Z']\n"
      ">>> mill.axis('A').point_mm = (0, 0, -50)\n");
  add_states(bound);
  bound
      .def_static(
          "from_chain", &machine_of_chain, nb::arg("chain"),
          "Machine of a chain such as \"w C' X' b Z t\" with default directions and travels.\n\n"
          "w workpiece, b bed, t tool; letters of ISO 841; a prime where a positive command moves the table the\n"
          "other way. Raises InputError for a chain that makes no sense.")
      .def_static("read", &read_machine, nb::arg("path"),
                  "Machine from a file (*.machine.toml). Raises InputError with file, line and field.")
      .def_static("parse", &parse_machine, nb::arg("text"), nb::arg("file") = "machine.toml",
                  "Machine from the text of a machine file; `file` is its name for messages.")
      .def("text", &machine_text, "Text of a machine file; Machine.parse() gives back the same machine.")
      .def(
          "write",
          [](const Machine& machine, const std::filesystem::path& path, bool overwrite) {
            write_text(path, machine_text(machine), overwrite);
          },
          nb::arg("path"), nb::arg("overwrite") = false,
          "Writes a machine file, whole or not at all. An existing file is only replaced with overwrite=True.")
      .def_rw("name", &Machine::name)
      .def_rw("description", &Machine::description)
      .def_prop_ro("chain", &Machine::chain, "The chain in words: \"w C' X' b Z t\".")
      .def_prop_ro(
          "axes",
          [](nb::handle_t<Machine> self) {
            nb::list axes;
            for (Axis& axis : nb::cast<Machine&>(self).axes)
              axes.append(nb::cast(axis, nb::rv_policy::reference_internal, self));
            return axes;
          },
          nb::sig("def axes(self) -> list[Axis]"), "The axes in the order of the chain, workpiece to tool.")
      .def("axis", &axis_named, nb::arg("name"), nb::rv_policy::reference_internal,
           "The axis of that name. Raises KeyError if there is none.")
      .def_prop_ro(
          "axis_names",
          [](const Machine& machine) {
            std::vector<std::string> names;
            for (const Axis& axis : machine.axes) names.push_back(axis.name);
            return names;
          },
          "Names of the axes in the order of the chain.")
      .def_prop_rw(
          "couplings", &couplings, &set_couplings,
          "What positions of axes contain of the commands of others: (axis, other axis, ratio) with\n"
          "position = command + ratio times command of the other. Ratios are numbers between axes of one kind,\n"
          "else mm per rad or rad per mm. Raises KeyError for a name that is no axis.")
      .def_prop_rw(
          "tool_reference_mm", [](const Machine& machine) { return machine.tool_reference; },
          [](Machine& machine, const Triple& value) { machine.tool_reference = vector(value); },
          "Spindle gauge point with all axes at zero, shape (3,), mm.")
      .def_prop_rw(
          "tool_offset_mm", [](const Machine& machine) { return machine.tool_offset; },
          [](Machine& machine, const Triple& value) { machine.tool_offset = vector(value); },
          "Functional point from the gauge point, shape (3,), mm.")
      .def_prop_rw(
          "tool_direction", [](const Machine& machine) { return machine.tool_direction; },
          [](Machine& machine, const Triple& value) { machine.tool_direction = vector(value); },
          "Unit vector from the functional point to the spindle, shape (3,).")
      .def_prop_rw(
          "bed_from_workpiece", [](const Machine& machine) { return matrix(machine.bed_from_workpiece); },
          [](Machine& machine, const ArrayLike& value) {
            machine.bed_from_workpiece = transform_of(value, "bed_from_workpiece");
          },
          "Workpiece frame in the machine frame with all axes at zero, shape (4, 4), mm.")
      .def("problems", &problems, "Everything that makes the machine unusable, a sentence each; empty if it is sound.")
      .def("remarks", &find_remarks, "What is allowed and seldom meant, a sentence each.")
      .def(
          "copy", [](const Machine& machine) { return machine; }, "A copy that can be changed on its own.")
      .def(
          "__eq__", [](const Machine& a, const Machine& b) { return machine_text(a) == machine_text(b); },
          nb::is_operator(), nb::sig("def __eq__(self, other: object, /) -> bool"))
      .def("__getstate__", [](const Machine& machine) { return machine_text(machine); })
      .def("__setstate__",
           [](Machine& machine, const std::string& text) {
             new (&machine) Machine(parse_machine(text, "pickled machine"));
           })
      .def("__repr__", [](const Machine& machine) {
        return fmt::format("<abbe.Machine {}{}>", machine.name.empty() ? "" : machine.name + ": ", machine.chain());
      });
}

}  // namespace abbe::python
