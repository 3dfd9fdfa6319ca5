#include <fmt/format.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/set.h>
#include <nanobind/stl/string.h>

#include "bindings/use/table_result.h"

namespace abbe::python {
namespace {

const char* kind_words(TableKind kind) {
  switch (kind) {
    case TableKind::own_axis:
      return "own axis";
    case TableKind::axis_pairs:
      return "axis pairs";
    case TableKind::lattice:
      return "lattice";
    case TableKind::error_model:
      return "error model";
    case TableKind::skew:
      return "skew";
  }
  return "";
}

void bind_format(nb::module_& module) {
  nb::class_<TableFormat>(module, "TableFormat", "A format of correction tables.")
      .def_ro("name", &TableFormat::name, "'siemens-cec'.")
      .def_ro("control", &TableFormat::control, "Whose tables they are: 'SINUMERIK'.")
      .def_prop_ro(
          "kind", [](const TableFormat& f) { return kind_words(f.kind); },
          "What corrections are looked up in: 'own axis', 'axis pairs', 'lattice', 'error model' or 'skew'.")
      .def_ro("what", &TableFormat::what, "One line.")
      .def_ro("convention", &TableFormat::convention, "Sign and units of the values, how the control uses them.")
      .def_ro("unverified", &TableFormat::unverified, "What of the syntax is not known for sure; empty: nothing.")
      .def_prop_ro(
          "takes",
          [](const TableFormat& f) {
            std::vector<std::string> names;
            for (const TableSetting setting : f.takes) names.push_back(argument_words(setting_option(setting)));
            return names;
          },
          "Options that this format has a use for; others are refused.")
      .def_ro("axis_names", &TableFormat::axis_names, "What names of axes are; empty: none are given.")
      .def_ro("file_per_axis", &TableFormat::file_per_axis, "Whether one axis alone is one file.")
      .def_ro("most_nodes", &TableFormat::most_nodes)
      .def_prop_ro("default_interpolation_um", [](const TableFormat& f) { return 1e3 * f.default_tolerance_mm; })
      .def_ro("cannot", &TableFormat::cannot, "Why what is not carried is not.")
      .def_ro("directions", &TableFormat::directions,
              "Whether tables differ by direction, so that reversal values are in them.")
      .def("__repr__", [](const TableFormat& f) { return fmt::format("<abbe.TableFormat {}: {}>", f.name, f.what); });
}

}  // namespace

void bind_table_parts(nb::module_& module) {
  bind_format(module);
  nb::class_<TableFigures>(module, "TableFigures", "One table, or what of the files can be left out like one.")
      .def_ro("name", &TableFigures::name, "'X', 'Y for X', 'EXX'.")
      .def_ro("nodes", &TableFigures::nodes)
      .def_ro("step_mm_rad", &TableFigures::step, "Between nodes.")
      .def_ro("step_is_angle", &TableFigures::step_is_angle, "Of step_mm_rad and largest_at_mm_rad.")
      .def_ro("is_angle", &TableFigures::is_angle, "Of the values.")
      .def_ro("largest_mm_rad", &TableFigures::largest, "Largest correction.")
      .def_ro("largest_at_mm_rad", &TableFigures::largest_at, "Command at which it is.")
      .def_ro("interpolation_error_mm_rad", &TableFigures::interpolation_error)
      .def_ro("within", &TableFigures::within, "Whether the tolerance of interpolation is kept.")
      .def_ro("standard_uncertainty_mm_rad", &TableFigures::standard_uncertainty,
              "Largest of a correction; None: the errors state none.")
      .def("__repr__",
           [](const TableFigures& t) { return fmt::format("<abbe.TableFigures {}: {} nodes>", t.name, t.nodes); });
  nb::class_<PoseDeviations>(module, "PoseDeviations", "Deviation of the tool at poses, actual minus nominal.")
      .def_prop_ro(
          "position_mm", [](const PoseDeviations& d) { return copied_array(d.position); },
          nb::sig("def position_mm(self) -> numpy.ndarray"), "[n] shift of the functional point, mm.")
      .def_prop_ro(
          "orientation_rad", [](const PoseDeviations& d) { return copied_array(d.orientation); },
          nb::sig("def orientation_rad(self) -> numpy.ndarray"), "[n] angle between the directions of the tool, rad.")
      .def_ro("position_statistics_mm", &PoseDeviations::position_statistics)
      .def_ro("orientation_statistics_rad", &PoseDeviations::orientation_statistics)
      .def("__repr__", [](const PoseDeviations& d) {
        return fmt::format("<abbe.PoseDeviations: {} poses, mean {:.3f} um, largest {:.3f} um>", d.position.size(),
                           1e3 * d.position_statistics.mean, 1e3 * d.position_statistics.maximum);
      });
  nb::class_<CarriedError>(module, "CarriedError", "How much of what one error does tables take away.")
      .def_ro("name", &CarriedError::name, "'EXX', 'EC0Y', 'reversal_X'.")
      .def_ro("is_angle", &CarriedError::is_angle, "Of size_mm_rad.")
      .def_ro("size_mm_rad", &CarriedError::size, "Largest value over the known travel of the axis.")
      .def_ro("effect_before_mm", &CarriedError::effect_before, "Root mean square shift of the functional point, mm.")
      .def_ro("effect_after_mm", &CarriedError::effect_after, "The same with tables made for this error alone, mm.")
      .def_ro("turn_before_rad", &CarriedError::turn_before, "Root mean square turn of the tool's direction, rad.")
      .def_ro("turn_after_rad", &CarriedError::turn_after)
      .def_prop_ro("carried", &CarriedError::carried,
                   "Share of the shift that is taken away; below zero where the tables make it worse.")
      .def("__repr__", [](const CarriedError& e) {
        return fmt::format("<abbe.CarriedError {}: {:.0f} %>", e.name, 100 * e.carried());
      });
}

}  // namespace abbe::python
