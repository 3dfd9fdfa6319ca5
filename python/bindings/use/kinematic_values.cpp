#include "abbe/controls/kinematic_values.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <nlohmann/json.hpp>

#include "abbe/controls/kinematic_values_text.h"
#include "bindings/files.h"
#include "bindings/use/arguments.h"
#include "bindings/use/carried_figures.h"

namespace abbe::python {
namespace {

/// Values with what their report needs.
struct KinematicResult {
  Machine machine;
  KinematicValues made;
  PartialErrors partial;
};

KinematicResult values_of(const MachineErrors& errors, const std::string& format, std::optional<std::size_t> positions,
                          std::optional<double> limit_um, std::optional<double> limit_urad,
                          double least_reduction_percent, std::optional<int> tool_carrier, const AxisPositions& at,
                          bool accept_misfit, const std::string& errors_file) {
  require_trusted(errors, accept_misfit, errors_file);
  KinematicValuesRequest request;
  request.format = format;
  request.machine = errors.machine;
  request.errors = errors.set();
  request.covariance = errors.file.covariance;
  request.tool_carrier = tool_carrier;
  request.positions = positions;
  request.at = axis_positions(errors.machine, "at", at);
  if (limit_um) request.limit_mm = 1e-3 * *limit_um;
  if (limit_urad) request.limit_rad = 1e-6 * *limit_urad;
  request.least_reduction = 0.01 * least_reduction_percent;
  KinematicResult result{errors.machine, {}, partial_errors(errors.machine, errors.file)};
  result.made = computed([&] { return make_kinematic_values(request); });
  return result;
}

KinematicValuesReport values_report(const KinematicResult& result, const std::vector<std::string>& written) {
  return {result.machine, result.made, result.partial, written};
}

const char* value_kind_words(ValueKind kind) {
  switch (kind) {
    case ValueKind::length:
      return "length";
    case ValueKind::direction:
      return "direction";
    case ValueKind::angle:
      return "angle";
  }
  return "";
}

const KinematicValue& value_called(const KinematicResult& result, const std::string& name) {
  for (const KinematicValue& value : result.made.values) {
    if (value.name == name) return value;
  }
  throw nb::key_error(fmt::format("no value '{}' for {}", name, result.made.format.name).c_str());
}

void bind_value_parts(nb::module_& module) {
  nb::class_<KinematicFormatWords>(module, "KinematicFormat", "A format of kinematic values.")
      .def_ro("name", &KinematicFormatWords::name, "'siemens'.")
      .def_ro("what", &KinematicFormatWords::what, "One line.")
      .def_ro("convention", &KinematicFormatWords::convention, "Frame, signs and units.")
      .def_ro("unverified", &KinematicFormatWords::unverified, "What no public source says; empty: nothing.")
      .def_ro("cannot", &KinematicFormatWords::cannot, "Why what is not carried is not.")
      .def("__repr__",
           [](const KinematicFormatWords& f) { return fmt::format("<abbe.KinematicFormat {}: {}>", f.name, f.what); });
  nb::class_<KinematicValue>(module, "KinematicValue", "One number that a control takes.")
      .def_ro("name", &KinematicValue::name, "'xyzac-trt-kins.x-rot-point', '$MC_TRAFO5_BASE_TOOL_1[0]'.")
      .def_prop_ro(
          "kind", [](const KinematicValue& v) { return value_kind_words(v.kind); },
          "'length' (mm), 'direction' (component of a unit vector) or 'angle' (rad).")
      .def_ro("nominal_mm_rad", &KinematicValue::nominal, "Of the machine; mm, rad or a component of a unit vector.")
      .def_ro("actual_mm_rad", &KinematicValue::actual, "With the location errors, as it is written, rounded.")
      .def_ro("standard_uncertainty_mm_rad", &KinematicValue::standard_uncertainty,
              "Of actual_mm_rad; None: the errors state none.")
      .def("__repr__",
           [](const KinematicValue& v) { return fmt::format("<abbe.KinematicValue {}: {:.6f}>", v.name, v.actual); });
}

}  // namespace

void bind_kinematic_values(nb::module_& module) {
  bind_value_parts(module);
  nb::class_<KinematicResult> bound(
      module, "KinematicValues",
      "Positions and directions of rotary axes for a control, and what they do and do not carry. Made by\n"
      "kinematic_values().");
  add_carried_figures(bound, "values", "with nominal values", "with these values");
  bound
      .def_prop_ro(
          "values", [](const KinematicResult& r) { return r.made.values; }, "All values, in the order of the file.")
      .def("__getitem__", &value_called, nb::arg("name"), nb::rv_policy::copy, "A value by its name.")
      .def("__len__", [](const KinematicResult& r) { return r.made.values.size(); })
      .def_prop_ro(
          "format", [](const KinematicResult& r) { return r.made.format; }, "The format that the values are in.")
      .def_prop_ro(
          "file_name", [](const KinematicResult& r) { return r.made.file.name; }, "As the control expects it.")
      .def_prop_ro(
          "file",
          [](const KinematicResult& r) { return r.made.says_no() ? std::nullopt : std::optional(r.made.file.text); },
          "Text of the file; None: refused.")
      .def_prop_ro(
          "left_by_values_mm", [](const KinematicResult& r) { return r.made.left_by_values; },
          "Volumetric error that these values leave, the datum fitted.")
      .def(
          "text",
          [](const KinematicResult& r, const std::vector<std::string>& written) {
            return kinematic_values_text(values_report(r, written));
          },
          nb::arg("written") = std::vector<std::string>{},
          "What `abbe compensate kinematics` prints. written: names of files.")
      .def(
          "to_dict",
          [](const KinematicResult& r, const std::vector<std::string>& written) {
            return python_value(kinematic_values_json(values_report(r, written)));
          },
          nb::arg("written") = std::vector<std::string>{},
          nb::sig("def to_dict(self, written: Sequence[str] = []) -> dict[str, typing.Any]"),
          "The same as `abbe compensate kinematics --json`.")
      .def(
          "write",
          [](const KinematicResult& r, const std::filesystem::path& path, bool overwrite) {
            refuse_to_write(argument_words(fmt::format("{}", fmt::join(r.made.refused, "; "))));
            write_text(path, r.made.file.text, overwrite);
          },
          nb::arg("path"), nb::arg("overwrite") = false,
          "Writes the file, whole or not at all. Raises InputError if the values must not be used.")
      .def("__repr__", [](const KinematicResult& r) {
        return fmt::format("<abbe.KinematicValues for {}: {} values{}>", r.made.format.name, r.made.values.size(),
                           r.made.says_no() ? ", refused" : "");
      });
  module.def(
      "kinematic_values", &values_of, nb::arg("errors"), nb::arg("format"), nb::kw_only(),
      nb::arg("positions") = nb::none(), nb::arg("limit_um") = nb::none(), nb::arg("limit_urad") = nb::none(),
      nb::arg("least_reduction_percent") = 1.0, nb::arg("tool_carrier") = nb::none(), nb::arg("at") = AxisPositions{},
      nb::arg("accept_misfit") = false, nb::arg("errors_file") = "errors.toml",
      "Positions and directions of rotary axes as a control with a five-axis transformation takes them.\n\n"
      "They are read back and tried in a simulated control: `abbe compensate kinematics`. format: a name of\n"
      "kinematic_formats(), such as 'siemens'. positions: per axis of the grid where deviations are stated. limit_um,\n"
      "limit_urad: larger changes of a length, of a direction or an angle are refused; least_reduction_percent: as "
      "are\n"
      "values that remove less of the displacement. tool_carrier (siemens): $TC_CARR of the tool carrier with this\n"
      "number instead of machine data. at: where axes stand for states that follow from the commands, mm or rad by "
      "axis;\n"
      "others in the middle of their travel. Raises InputError, also for a machine whose chain the control does not "
      "have.\n"
      "Formats and method: docs/kinematic-values.md.\n\n"
      ">>> import abbe\n"
      ">>> mill = abbe.Machine.from_chain(\"w C' X' Y' b Z t\")\n"
      ">>> errors = abbe.Errors(mill)\n"
      ">>> errors.add_location('EX0C', value_um=20)\n"
      ">>> values = abbe.kinematic_values(errors, 'values')\n"
      ">>> values.refused, values['C,machine,x_mm'].actual_mm_rad\n"
      "([], 0.02)\n");
  module.def(
      "kinematic_formats", [] { return kinematic_formats(); }, "All formats of kinematic_values().");
}

}  // namespace abbe::python
