#include "abbe/study/compensation/corrected_commands.h"

#include <fmt/format.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <nlohmann/json.hpp>

#include "abbe/formats/readings/measurement_file.h"
#include "bindings/files.h"
#include "bindings/states.h"
#include "bindings/use/arguments.h"

namespace abbe::python {
namespace {

CorrectedCommands commands_of(const MachineErrors& errors, const ArrayLike& positions,
                              const std::vector<std::string>& hold, std::optional<double> largest_turn_deg,
                              double leave_out, std::optional<double> limit_um, bool accept_misfit,
                              const StatesArgument& states, const std::string& machine_file,
                              const std::string& errors_file) {
  require_trusted(errors, accept_misfit, errors_file);
  const Positions poses(positions, errors.machine);
  if (poses.single()) throw InputError({.field = "positions_mm_rad"}, "is a single pose", "shape (n, axes)");
  CommandsRequest request;
  request.machine = errors.machine;
  request.errors = errors.file;
  request.poses = poses.list();
  GivenColumns(states, errors.machine, errors.set(), poses.count()).put_into(request.poses);
  request.machine_file = machine_file;
  request.errors_file = errors_file;
  request.held = axis_indices(errors.machine, hold);
  if (largest_turn_deg) request.largest_turn = *largest_turn_deg * kDegree;
  request.leave_out_factor = leave_out;
  request.limit_um = limit_um;
  return computed([&] { return correct_commands(request); });
}

nb::object command_statuses(const CorrectedCommands& result) {
  std::vector<std::uint8_t> values;
  for (const CorrectionStatus status : result.corrected.status) values.push_back(static_cast<std::uint8_t>(status));
  return array_of(std::move(values));
}

nb::object reached(const CorrectedCommands& result) {
  std::vector<std::uint8_t> values;
  for (const CorrectionStatus status : result.corrected.status) values.push_back(reaches_point(status) ? 1 : 0);
  return array_of_bools(std::move(values));
}

std::map<std::string, std::size_t> counts(const CorrectedCommands& result) {
  std::map<std::string, std::size_t> counted;
  for (std::size_t i = 1; i < kCorrectionStatuses; ++i) {
    if (result.corrected.count[i] == 0) continue;
    counted[correction_status_text(static_cast<CorrectionStatus>(i))] = result.corrected.count[i];
  }
  return counted;
}

/// A figure and its pose, counted from 0 as arrays are; None: nowhere.
std::pair<double, std::optional<std::size_t>> largest(const LargestOfRows& figure) {
  return {figure.value, figure.row > 0 ? std::optional(figure.row - 1) : std::nullopt};
}

}  // namespace

void bind_corrected_commands(nb::module_& module) {
  nb::class_<CorrectedCommands>(module, "CorrectedCommands",
                                "Corrected commands with uncertainties, and what is left. Made by correct_commands().")
      .def_prop_ro(
          "positions_mm_rad", [](const CorrectedCommands& r) { return copied_poses(r.corrected.commands); },
          nb::sig("def positions_mm_rad(self) -> numpy.ndarray"), "[n, axes] corrected commands, mm or rad.")
      .def_prop_ro("status", &command_statuses, nb::sig("def status(self) -> numpy.ndarray"),
                   "[n] index into CORRECTION_STATUSES.")
      .def_prop_ro("reached", &reached, nb::sig("def reached(self) -> numpy.ndarray"),
                   "[n] whether the point is where it is wanted.")
      .def_prop_ro(
          "position_left_mm", [](const CorrectedCommands& r) { return copied_array(r.corrected.position_left); },
          nb::sig("def position_left_mm(self) -> numpy.ndarray"), "[n] mm; NaN where it is not known.")
      .def_prop_ro(
          "orientation_left_rad", [](const CorrectedCommands& r) { return copied_array(r.corrected.orientation_left); },
          nb::sig("def orientation_left_rad(self) -> numpy.ndarray"), "[n] rad; NaN where it is not known.")
      .def_prop_ro(
          "shift_mm", [](const CorrectedCommands& r) { return copied_array(r.corrected.shift); },
          nb::sig("def shift_mm(self) -> numpy.ndarray"),
          "[n] by which the functional point is moved, mm; NaN where it is not known.")
      .def_prop_ro(
          "uncertainty_mm",
          [](const CorrectedCommands& r) -> nb::object {
            if (r.corrected.uncertainty.empty()) return nb::none();
            return copied_array(r.corrected.uncertainty);
          },
          nb::sig("def uncertainty_mm(self) -> numpy.ndarray | None"),
          "[n] standard uncertainty of shift_mm (JCGM 100), mm; None: the errors state none.")
      .def_prop_ro("counts", &counts, "Poses of every status that occurs.")
      .def_prop_ro(
          "largest_shift_mm", [](const CorrectedCommands& r) { return largest(r.corrected.largest_shift); },
          "Largest of shift_mm, and the index of its pose.")
      .def_prop_ro(
          "largest_position_left_mm",
          [](const CorrectedCommands& r) { return largest(r.corrected.largest_position_left); },
          "Largest of position_left_mm, and the index of its pose.")
      .def_prop_ro(
          "largest_orientation_left_rad",
          [](const CorrectedCommands& r) { return largest(r.corrected.largest_orientation_left); },
          "Largest of orientation_left_rad, and the index of its pose.")
      .def_prop_ro(
          "largest_by_axis_mm_rad",
          [](const CorrectedCommands& r) {
            std::map<std::string, std::pair<double, std::optional<std::size_t>>> by_axis;
            for (std::size_t i = 0; i < r.corrected.by_axis.size(); ++i) {
              by_axis[r.machine.axes[i].name] = largest(r.corrected.by_axis[i]);
            }
            return by_axis;
          },
          "Largest change of the commands of each axis, mm or rad, and the index of its pose.")
      .def_prop_ro(
          "left_out", [](const CorrectedCommands& r) { return r.corrected.left_out; },
          "Errors below their uncertainty, which are not corrected.")
      .def_ro("refused", &CorrectedCommands::refused, "Why the commands must not be used, in words; empty: they may.")
      .def_ro("not_reached", &CorrectedCommands::not_reached, "Poses to which the tool is not brought.")
      .def_ro("has_reversals", &CorrectedCommands::has_reversals,
              "Whether the errors have reversal values, which are not in the commands.")
      .def("csv", &corrected_commands_csv, "Text of the file of `abbe compensate poses`: a row for each pose.")
      .def("text", &corrected_commands_text, "What `abbe compensate poses` prints of the result.")
      .def(
          "to_dict",
          [](const CorrectedCommands& r, const std::optional<std::string>& output) {
            return python_value(corrected_commands_json(r, output.value_or(""), output && r.refused.empty()));
          },
          nb::arg("output") = nb::none(),
          nb::sig("def to_dict(self, output: str | None = None) -> dict[str, typing.Any]"),
          "The same as `abbe compensate poses --json`. output: name of the file that is written.")
      .def(
          "write",
          [](const CorrectedCommands& r, const std::filesystem::path& path, bool overwrite) {
            refuse_to_write(argument_words(r.refused));
            write_text(path, corrected_commands_csv(r), overwrite);
          },
          nb::arg("path"), nb::arg("overwrite") = false,
          "Writes csv(), whole or not at all. Raises InputError if the commands are refused.")
      .def("__repr__", [](const CorrectedCommands& r) {
        return fmt::format("<abbe.CorrectedCommands: {} poses, {} not reached, largest shift {:.3f} um{}>",
                           r.poses.count(), r.not_reached, 1e3 * r.corrected.largest_shift.value,
                           r.refused.empty() ? "" : ", refused");
      });
  module.def(
      "correct_commands", &commands_of, nb::arg("errors"), nb::arg("positions_mm_rad"), nb::kw_only(),
      nb::arg("hold") = std::vector<std::string>{}, nb::arg("largest_turn_deg") = nb::none(),
      nb::arg("leave_out_below_uncertainty") = 0.0, nb::arg("limit_um") = nb::none(), nb::arg("accept_misfit") = false,
      nb::arg("states") = nb::none(), nb::arg("machine_file") = "machine.toml", nb::arg("errors_file") = "errors.toml",
      "Commands that bring the actual tool to where the nominal machine has it, with uncertainties.\n\n"
      "positions_mm_rad [n, axes]: nominal commands. hold: axes that keep their commands. largest_turn_deg: of\n"
      "rotary axes; None: 0.5, of an arm 5. leave_out_below_uncertainty: errors below so many of their standard\n"
      "uncertainties are left out. limit_um: larger corrections are refused. states: as in PoseModel.poses().\n"
      "Without uncertainties and texts,\n"
      "CompensatedInverse is quicker. Method: docs/compensation.md.\n\n"
      ">>> import abbe\n"
      ">>> mill = abbe.Machine.from_chain(\"w X' Y' b Z t\")\n"
      ">>> errors = abbe.Errors(mill)\n"
      ">>> errors.add_location('EC0Y', value_urad=20, u_urad=2)\n"
      ">>> result = abbe.correct_commands(errors, [[100, 100, 0]])\n"
      ">>> result.positions_mm_rad.round(6).tolist(), result.uncertainty_mm.round(6).tolist()\n"
      "([[100.002, 100.0, 0.0]], [0.0002])\n");
  if (!nb::hasattr(module, "read_poses")) {
    module.def(
        "read_poses",
        [](const std::filesystem::path& path, const Machine& machine) {
          return copied_poses(read_poses(path, machine));
        },
        nb::arg("path"), nb::arg("machine"),
        nb::sig("def read_poses(path: str | os.PathLike, machine: Machine) -> numpy.ndarray"),
        "Axis commands [n, axes] from a CSV with one column per axis (X_mm, C_deg, ...).");
  }
}

}  // namespace abbe::python
