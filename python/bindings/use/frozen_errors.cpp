#include "abbe/study/compensation/frozen_errors.h"

#include <fmt/format.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <nlohmann/json.hpp>

#include "bindings/files.h"
#include "bindings/use/arguments.h"

namespace abbe::python {
namespace {

FrozenErrors frozen_of(const MachineErrors& errors, const std::optional<Triple>& tool,
                       std::pair<double, double> lengths, double largest_turn_deg, const std::string& world,
                       double leave_out, std::optional<double> limit_um, bool accept_misfit, const std::string& file) {
  require_trusted(errors, accept_misfit, file);
  FreezeRequest request;
  request.machine = errors.machine;
  request.errors = errors.file;
  request.errors_file = file;
  if (tool) request.tool = Eigen::Vector3d((*tool)[0], (*tool)[1], (*tool)[2]);
  request.tool_length_min = lengths.first;
  request.tool_length_max = lengths.second;
  request.largest_turn = largest_turn_deg * kDegree;
  if (world != "joints" && world != "workpiece") {
    throw InputError({.field = "world"}, fmt::format("'{}' is no origin", world), "'joints' or 'workpiece'");
  }
  request.world_zero_at_joints = world == "joints";
  request.leave_out_factor = leave_out;
  request.limit_um = limit_um;
  return computed([&] { return freeze_errors(request); });
}

/// @param output  the file that is written; none: a dry run
FrozenOutput output_of(const FrozenErrors& result, const std::optional<std::string>& output) {
  return {.file = output.value_or(""), .written = output && result.refused.empty(), .dry_run = !output};
}

std::optional<double> known(std::size_t count, double value) { return count > 0 ? std::optional(value) : std::nullopt; }

std::optional<double> stated(const FrozenErrors& result, double value) {
  return known(result.frozen.largest_uncertainty > 0 ? 1 : 0, value);
}

nb::object largest_joint_places(const FrozenErrors& result) {
  const std::size_t axes = result.machine.axes.size();
  std::vector<double> places;
  for (const std::vector<double>& at : result.frozen.largest_joint_at) {
    places.insert(places.end(), at.begin(), at.end());
    places.resize((places.size() + axes - 1) / axes * axes, 0.0);
  }
  places.resize(axes * axes, 0.0);
  return array_of(std::move(places), {axes, axes});
}

void bind_figures(nb::class_<FrozenErrors>& bound) {
  bound
      .def_prop_ro(
          "largest_correction_mm", [](const FrozenErrors& f) { return f.frozen.largest_correction; },
          "Of the tool point over the poses that were tried, mm.")
      .def_prop_ro(
          "largest_correction_turn_rad", [](const FrozenErrors& f) { return f.frozen.largest_correction_turn; },
          "Of the tool direction, rad.")
      .def_prop_ro(
          "where_mm_rad", [](const FrozenErrors& f) { return copied_array(f.frozen.where); },
          nb::sig("def where_mm_rad(self) -> numpy.ndarray"), "[axes] nominal commands of largest_correction_mm.")
      .def_prop_ro(
          "tool_length_there_mm", [](const FrozenErrors& f) { return f.frozen.tool_length_there; }, "mm.")
      .def_prop_ro(
          "largest_joint_mm_rad", [](const FrozenErrors& f) { return copied_array(f.frozen.largest_joint); },
          nb::sig("def largest_joint_mm_rad(self) -> numpy.ndarray"), "[axes] largest correction of each axis.")
      .def_prop_ro("largest_joint_at_mm_rad", &largest_joint_places,
                   nb::sig("def largest_joint_at_mm_rad(self) -> numpy.ndarray"),
                   "[axes, axes] nominal commands there, a row for each axis.")
      .def_prop_ro(
          "accuracy_mm", [](const FrozenErrors& f) { return known(f.frozen.points_compared, f.frozen.accuracy); },
          "Largest distance of the compensated tool from where it should be, by the full model of all errors, mm;\n"
          "None where no pose could be compared.")
      .def_prop_ro(
          "accuracy_turn_rad",
          [](const FrozenErrors& f) { return known(f.frozen.directions_compared, f.frozen.accuracy_turn); },
          "The same of its direction, rad.")
      .def_prop_ro(
          "difference_mm", [](const FrozenErrors& f) { return known(f.frozen.points_compared, f.frozen.difference); },
          "The same by the errors that are frozen, mm: what freezing itself changes.")
      .def_prop_ro(
          "largest_uncertainty_mm", [](const FrozenErrors& f) { return stated(f, f.frozen.largest_uncertainty); },
          "Largest standard uncertainty of the correction of the point, mm; None: the errors state none.")
      .def_prop_ro(
          "mean_uncertainty_mm", [](const FrozenErrors& f) { return stated(f, f.frozen.mean_uncertainty); },
          "Its mean, mm.")
      .def_prop_ro(
          "uncertainty_lattice_mm", [](const FrozenErrors& f) { return stated(f, f.frozen.uncertainty_lattice); },
          "Largest difference of the file's uncertainty from the full model's, mm.")
      .def_prop_ro(
          "worst_iterations", [](const FrozenErrors& f) { return f.frozen.worst_iterations; }, "Of all calls.")
      .def_prop_ro(
          "poses", [](const FrozenErrors& f) { return f.frozen.poses; }, "Poses that were tried.")
      .def_prop_ro(
          "limited", [](const FrozenErrors& f) { return f.frozen.limited; },
          "Poses at which the turn is bounded, so that a part of the orientation error stays.")
      .def_prop_ro(
          "unreached", [](const FrozenErrors& f) { return f.frozen.unreached; }, "Poses whose point is not reached.")
      .def_prop_ro(
          "points_compared", [](const FrozenErrors& f) { return f.frozen.points_compared; },
          "Poses that accuracy_mm is the largest of.")
      .def_prop_ro("directions_compared", [](const FrozenErrors& f) { return f.frozen.directions_compared; })
      .def_prop_ro(
          "point_axes", [](const FrozenErrors& f) { return f.frozen.point_axes; },
          "Axes that take the error of the point; all of it needs three.")
      .def_prop_ro(
          "checksum", [](const FrozenErrors& f) { return f.frozen.checksum; }, "Of the file.")
      .def_prop_ro(
          "source_checksum", [](const FrozenErrors& f) { return f.frozen.source_checksum; }, "Of machine and errors.");
}

}  // namespace

void bind_frozen_errors(nb::module_& module) {
  nb::class_<FrozenErrors> bound(
      module, "FrozenErrors",
      "Machine and errors as one file for a control, and what was found by trying it. Made by freeze().");
  bound
      .def_prop_ro(
          "bytes", [](const FrozenErrors& f) { return nb::bytes(f.bytes().data(), f.bytes().size()); },
          "Contents of the file (*.abbec). FrozenCompensation computes with them.")
      .def_ro("refused", &FrozenErrors::refused, "Why the file must not be used, in words; empty: it may be.")
      .def_ro("machine", &FrozenErrors::machine)
      .def_ro("left_out", &FrozenErrors::left_out, "Errors below their uncertainty, which are not in the file.")
      .def(
          "text",
          [](const FrozenErrors& f, const std::optional<std::string>& output) {
            return frozen_errors_text(f, output_of(f, output));
          },
          nb::arg("output") = nb::none(),
          "What `abbe compensate freeze` prints. output: name of the file that is written; without one of a dry run.")
      .def(
          "to_dict",
          [](const FrozenErrors& f, const std::optional<std::string>& output) {
            return python_value(frozen_errors_json(f, output_of(f, output)));
          },
          nb::arg("output") = nb::none(),
          nb::sig("def to_dict(self, output: str | None = None) -> dict[str, typing.Any]"),
          "The same as `abbe compensate freeze --json`.")
      .def(
          "write",
          [](const FrozenErrors& f, const std::filesystem::path& path, bool overwrite) {
            refuse_to_write(argument_words(f.refused));
            write_text(path, f.bytes(), overwrite);
          },
          nb::arg("path"), nb::arg("overwrite") = false,
          "Writes the file (*.abbec), whole or not at all. Raises InputError if it is refused, FileExistsError for a\n"
          "file that is there unless overwrite=True.")
      .def("__repr__", [](const FrozenErrors& f) {
        return fmt::format("<abbe.FrozenErrors of {}: {} bytes, largest correction {:.1f} um{}>", f.machine.name,
                           f.frozen.bytes.size(), 1e3 * f.frozen.largest_correction,
                           f.refused.empty() ? "" : ", refused");
      });
  bind_figures(bound);
  module.def(
      "freeze", &frozen_of, nb::arg("errors"), nb::kw_only(), nb::arg("tool_mm") = nb::none(),
      nb::arg("tool_length_mm") = std::pair(0.0, 300.0), nb::arg("largest_turn_deg") = 0.57,
      nb::arg("world") = "joints", nb::arg("leave_out_below_uncertainty") = 0.0, nb::arg("limit_um") = nb::none(),
      nb::arg("accept_misfit") = false, nb::arg("errors_file") = "errors.toml",
      "Compiles errors into a file that a control uses in real time, and tries it at poses all over the travel.\n\n"
      "tool_mm: functional point from the gauge point for calls without a tool; else that of the machine.\n"
      "tool_length_mm: shortest and longest tool that are tried. largest_turn_deg: of all rotary axes together, near\n"
      "singularities. world: origin of world coordinates, 'joints' (zero where all joints are) or 'workpiece'.\n"
      "leave_out_below_uncertainty: errors below so many of their standard uncertainties are left out.\n"
      "limit_um: larger corrections are refused. accept_misfit: use errors that are marked as not to be trusted.\n"
      "errors_file: name of the errors for texts. Raises InputError for errors that cannot be frozen. Method:\n"
      "docs/runtime.md.\n\n"
      ">>> import abbe\n"
      ">>> mill = abbe.Machine.from_chain(\"w X' Y' b Z t\")\n"
      ">>> errors = abbe.Errors(mill)\n"
      ">>> errors.add_location('EC0Y', value_urad=20)\n"
      ">>> frozen = abbe.freeze(errors, limit_um=500)\n"
      ">>> frozen.refused, round(frozen.largest_correction_mm, 6)\n"
      "('', 0.005)\n"
      ">>> frozen.compensation().correct([100, 100, 0]).positions_mm_rad.round(6).tolist()\n"
      "[100.002, 100.0, 0.0]\n");
}

}  // namespace abbe::python
