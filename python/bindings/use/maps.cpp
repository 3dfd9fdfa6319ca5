#include <fmt/format.h>
#include <nanobind/eigen/dense.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <nlohmann/json.hpp>

#include "abbe/formats/machine/map_file.h"
#include "abbe/study/compensation/errors_map.h"
#include "bindings/files.h"
#include "bindings/job.h"
#include "bindings/states.h"
#include "bindings/use/map_parts.h"

namespace abbe::python {
namespace {

constexpr const char* kStep = "mapping the volumetric error";

ErrorsMap map_of(const MachineErrors& errors, const MachineErrors* minus, const std::optional<ArrayLike>& positions,
                 const AxisRanges& grid, bool keep_datum, const std::optional<std::string>& poses_words,
                 const nb::object& progress) {
  ErrorsMapRequest request;
  request.machine = errors.machine;
  request.errors = errors.file;
  if (minus != nullptr) {
    require_same_machine(errors.machine, minus->machine, "minus");
    request.minus = minus->file;
  }
  if (positions) {
    if (!grid.empty()) throw InputError({.field = "grid"}, "is given together with positions_mm_rad", "one of them");
    const Positions given(*positions, errors.machine);
    if (given.single()) throw InputError({.field = "positions_mm_rad"}, "is a single pose", "shape (n, axes)");
    request.poses.emplace();
    request.poses->poses = given.list();
    request.poses->words = poses_words.value_or(fmt::format("{} poses", given.count()));
  }
  request.grid = axis_ranges(errors.machine, "grid", grid, true);
  request.fit_datum = !keep_datum;
  return job_result(progress, [&](const JobControl& control) {
    return naming_arguments([&] { return map_errors(request, control.options(kStep)); });
  });
}

void write_map(const ErrorsMap& map, const std::filesystem::path& path, bool overwrite) {
  const MapData data = errors_map_data(map);
  require_map_name(path.string(), data);
  write_text(path, map_text(path.string(), data), overwrite);
}

VolumetricFigures figures_of(const MachineErrors& errors, const MachineErrors* truth, const AxisRanges& grid) {
  const Machine& machine = errors.machine;
  require_no_given_states(errors);
  if (truth != nullptr) require_no_given_states(*truth);
  std::vector<const ErrorSet*> sets{&errors.set()};
  if (truth != nullptr) {
    require_same_machine(machine, truth->machine, "truth");
    sets.push_back(&truth->set());
  }
  std::vector<AxisRange> ranges = stated_ranges(machine, sets);
  const auto given = axis_ranges(machine, "grid", grid, true);
  for (std::size_t i = 0; i < ranges.size(); ++i) ranges[i] = given[i].value_or(ranges[i]);
  check_grid(ranges);
  return computed([&] {
    return volumetric_figures(machine, &errors.set(), covariance_of(errors.file), truth ? &truth->set() : nullptr,
                              grid_over(machine, ranges));
  });
}

SampleStatistics statistics_of(const MachineErrors& errors, const MachineErrors* minus, const AxisRanges& grid,
                               bool keep_datum, const nb::object& progress) {
  const Machine& machine = errors.machine;
  require_no_given_states(errors);
  if (minus != nullptr) {
    require_same_machine(machine, minus->machine, "minus");
    require_no_given_states(*minus);
  }
  std::vector<AxisRange> ranges = stated_ranges(machine, {&errors.set()});
  const auto given = axis_ranges(machine, "grid", grid, true);
  PoseGrid poses;
  double count = 1;
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const AxisRange range = given[i].value_or(ranges[i]);
    poses.values.push_back(evenly_spaced(range.from, range.to, range.count));
    count *= static_cast<double>(range.count);
  }
  constexpr double kMost = 2e9;  // 16 GB
  if (count > kMost) throw InputError({.field = "grid"}, fmt::format("{:.3g} poses", count), "at most 2e9 poses");
  return job_result(progress, [&](const JobControl& control) {
    ErrorMapOptions options;
    options.orientation = false;
    options.remove_rigid_motion = !keep_datum;
    options.progress = stoppable_progress(control.options(kStep));
    return stream_error_map(machine, errors.set(), minus ? &minus->set() : nullptr, pose_source(poses), options,
                            [](const ErrorMapBlock&) {});
  });
}

using Shares = std::vector<ErrorShare> (*)(const Machine&, const ErrorSet&, const PoseSource&, int);

std::vector<ErrorShare> shares(Shares function, const MachineErrors& errors, const ArrayLike& positions) {
  require_no_given_states(errors);
  const Positions given(positions, errors.machine);
  const PoseList list = given.list();
  return computed([&] { return function(errors.machine, errors.set(), pose_source(list), 0); });
}

void bind_functions(nb::module_& module) {
  module.def(
      "map_errors", &map_of, nb::arg("errors"), nb::kw_only(), nb::arg("minus").none() = nb::none(),
      nb::arg("positions_mm_rad") = nb::none(), nb::arg("grid") = AxisRanges{}, nb::arg("keep_datum") = false,
      nb::arg("poses_words") = nb::none(), nb::arg("progress") = nb::none(),
      "Volumetric error over a grid or at given commands, before and after a correction, with uncertainties.\n\n"
      "minus: errors that are corrected for; adds what is left. positions_mm_rad [n, axes], or grid: {'X_mm': (0, "
      "400,\n"
      "9), 'Z_mm': -100}, from, to and count or a position; axes that are not named run over the range in which all\n"
      "errors are known. keep_datum: displacements with the workpiece where it is, not the volumetric error after the\n"
      "best fit of its datum. progress: a function of the step, the poses done and their number. Raises InputError "
      "for\n"
      "a grid of more than 20,000,000 poses. Sources: ISO 230-1:2012, 3.4; JCGM 100. Figures: docs/conventions.md.\n\n"
      ">>> import abbe\n"
      ">>> mill = abbe.Machine.from_chain(\"w X' Y' b Z t\")\n"
      ">>> errors = abbe.Errors(mill)\n"
      ">>> errors.add_location('EC0Y', value_urad=20)\n"
      ">>> map = abbe.map_errors(errors, grid={'X_mm': (0, 100, 2), 'Y_mm': (0, 100, 2), 'Z_mm': 0}, keep_datum=True)\n"
      ">>> map.before.displacement_mm.round(6).tolist()[-1], map.before.statistics_mm.count\n"
      "([-0.002, -0.0, 0.0], 4)\n");
  module.def(
      "volumetric_figures", &figures_of, nb::arg("errors"), nb::kw_only(), nb::arg("truth").none() = nb::none(),
      nb::arg("grid") = AxisRanges{},
      "Volumetric error in the figures that all commands state, over one grid (docs/conventions.md).\n\n"
      "errors: identified ones. truth: true errors of a simulated machine. grid: as map_errors(); else 9 positions\n"
      "per axis, 5 above 3 axes, where all errors are known.");
  module.def("map_statistics", &statistics_of, nb::arg("errors"), nb::kw_only(), nb::arg("minus").none() = nb::none(),
             nb::arg("grid") = AxisRanges{}, nb::arg("keep_datum") = false, nb::arg("progress") = nb::none(),
             "Statistics of the volumetric error over a grid of any size, mm: 8 bytes are kept for each pose.\n\n"
             "Arguments as map_errors(); reversal values are not applied.");
  module.def(
      "shares_by_axis",
      [](const MachineErrors& errors, const ArrayLike& positions) {
        return shares(&shares_by_axis, errors, positions);
      },
      nb::arg("errors"), nb::arg("positions_mm_rad"),
      "How much the errors of each axis contribute, motions and location errors together, at commands [n, axes].");
  module.def(
      "shares_by_kind",
      [](const MachineErrors& errors, const ArrayLike& positions) {
        return shares(&shares_by_kind, errors, positions);
      },
      nb::arg("errors"), nb::arg("positions_mm_rad"),
      "How much translational and rotational error motions, location errors and tool offset contribute, at commands\n"
      "[n, axes].");
}

}  // namespace

void bind_maps(nb::module_& module) {
  bind_map_parts(module);
  nb::class_<ErrorsMap>(module, "ErrorsMap", "Volumetric error at poses. Made by map_errors().")
      .def_prop_ro(
          "positions_mm_rad", [](const ErrorsMap& m) { return copied_poses(m.stated.poses); },
          nb::sig("def positions_mm_rad(self) -> numpy.ndarray"), "[n, axes] commands.")
      .def_prop_ro(
          "grid", [](const ErrorsMap& m) { return m.stated.grid; },
          "Positions per axis, the last axis varies fastest; empty for given commands.")
      .def_prop_ro(
          "poses_words", [](const ErrorsMap& m) { return m.stated.words; }, "The poses in words.")
      .def_ro("machine", &ErrorsMap::machine)
      .def_prop_ro(
          "before", [](const ErrorsMap& m) { return &m.before; }, nb::rv_policy::reference_internal, "Of the errors.")
      .def_prop_ro(
          "after", [](const ErrorsMap& m) { return m.after ? &*m.after : nullptr; }, nb::rv_policy::reference_internal,
          nb::sig("def after(self) -> ErrorMap | None"), "What is left after the correction; None without one.")
      .def_ro("after_is_true", &ErrorsMap::after_is_true, "Whether the errors are the truth of a simulation.")
      .def_ro("figures", &ErrorsMap::figures, "Figures that all commands state; None with keep_datum=True.")
      .def_ro("partial", &ErrorsMap::partial, "What the errors do not state.")
      .def_prop_ro("left_out", &ErrorsMap::left_out, "Poses without a result.")
      .def(
          "csv", [](const ErrorsMap& m) { return map_csv(errors_map_data(m)); }, "Text of the map file (.csv).")
      .def(
          "vtk",
          [](const ErrorsMap& m) {
            const std::string text = map_vtk(errors_map_data(m));
            return nb::bytes(text.data(), text.size());
          },
          "The map for ParaView, VTK XML: .vts where it is_structured, else .vtu.")
      .def_prop_ro(
          "is_structured", [](const ErrorsMap& m) { return map_is_structured(errors_map_data(m)); },
          "A grid with at most three directions.")
      .def("text", &errors_map_text, "What `abbe map` prints.")
      .def(
          "to_dict", [](const ErrorsMap& m) { return python_value(errors_map_json(m)); },
          nb::sig("def to_dict(self) -> dict[str, typing.Any]"), "The same as `abbe map --json`.")
      .def("write", &write_map, nb::arg("path"), nb::arg("overwrite") = false,
           "Writes a map file, .csv, or .vts or .vtu as it is_structured.")
      .def("__repr__", [](const ErrorsMap& m) {
        return fmt::format("<abbe.ErrorsMap: {} poses, mean {:.3f} um, largest {:.3f} um>", m.before.count(),
                           1e3 * m.before.statistics.mean, 1e3 * m.before.statistics.maximum);
      });
  bind_functions(module);
}

}  // namespace abbe::python
