#include <fmt/format.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <cmath>

#include "bindings/arrays.h"
#include "bindings/evaluate/evaluations.h"
#include "bindings/evaluate/thermal_parts.h"

namespace abbe::python {
namespace {

template <class Test, class Read, class Parse>
Evaluation thermal_test(const ReadingsArgument& argument, const OptionNumbers& options,
                        std::span<const TestNumber<Test>> known, const Read& read, const Parse& parse,
                        const Tolerances& tolerances, const std::string& file) {
  Test test;
  enter_numbers(options, known, test);
  const GivenReadings given = given_readings(argument);
  test.readings = readings_of(given, read, parse);
  return evaluate_test(std::move(test), name_of(given, file), tolerances);
}

ThermalReadings read_sensors(const std::filesystem::path& path) { return read_thermal(path); }
ThermalReadings parse_sensors(const NamedColumns& columns) { return parse_thermal(columns); }
AxisDistortionReadings read_targets(const std::filesystem::path& path) { return read_axis_distortion(path); }
AxisDistortionReadings parse_targets(const NamedColumns& columns) { return parse_axis_distortion(columns); }

Evaluation etve(const ReadingsArgument& readings, const OptionNumbers& options, const Tolerances& tolerances,
                const std::string& file) {
  return thermal_test<EtveTest>(readings, options, etve_numbers(), read_sensors, parse_sensors, tolerances, file);
}

Evaluation spindle_distortion(const ReadingsArgument& readings, const OptionNumbers& options,
                              const Tolerances& tolerances, const std::string& file) {
  return thermal_test<SpindleDistortionTest>(readings, options, spindle_distortion_numbers(), read_sensors,
                                             parse_sensors, tolerances, file);
}

Evaluation axis_distortion(const ReadingsArgument& readings, const OptionNumbers& options, const Tolerances& tolerances,
                           const std::string& file) {
  return thermal_test<AxisDistortionTest>(readings, options, axis_distortion_numbers(), read_targets, parse_targets,
                                          tolerances, file);
}

const char* response_word(ResponseStatus status) {
  switch (status) {
    case ResponseStatus::not_run:
      return "not run";
    case ResponseStatus::done:
      return "done";
    case ResponseStatus::too_few_readings:
      return "too few readings";
    case ResponseStatus::no_change:
      return "no change";
    case ResponseStatus::not_first_order:
      return "not first order";
    case ResponseStatus::not_identified:
      return "not identified";
  }
  return "";
}

double if_done(const FirstOrderResponse& response, double value) {
  return response.status == ResponseStatus::done ? value : NAN;
}

void bind_thermal_parts(nb::module_& module) {
  nb::class_<SensorSeries>(module, "SensorSeries", "What one sensor of a thermal test read over time.")
      .def_prop_ro("name", [](const SensorSeries& s) { return s.series.name; })
      .def_prop_ro(
          "unit", [](const SensorSeries& s) { return s.unit; }, "Of the values: 'mm', 'rad' or 'degC'.")
      .def_prop_ro(
          "time_s", [](const SensorSeries& s) { return copied_array(s.series.time); },
          nb::sig("def time_s(self) -> numpy.ndarray"), "[n] increasing.")
      .def_prop_ro(
          "values", [](const SensorSeries& s) { return copied_array(s.series.values); },
          nb::sig("def values(self) -> numpy.ndarray"), "[n]")
      .def("__len__", [](const SensorSeries& s) { return s.series.time.size(); })
      .def("__repr__", [](const SensorSeries& s) {
        return fmt::format("<abbe.SensorSeries '{}': {} readings in {}>", s.series.name, s.series.time.size(), s.unit);
      });
  nb::class_<FirstOrderResponse>(module, "FirstOrderResponse",
                                 "start + change (1 - exp(-(t - from_s) / time_constant_s)). NaN: there is none.")
      .def_prop_ro(
          "status", [](const FirstOrderResponse& r) { return response_word(r.status); },
          "'done', or why there is no time constant.")
      .def_ro("from_s", &FirstOrderResponse::from, "First time of the fit.")
      .def_ro("to_s", &FirstOrderResponse::to, "Last time of the fit.")
      .def_prop_ro(
          "start_mm_rad", [](const FirstOrderResponse& r) { return if_done(r, r.start); }, "Value at from_s.")
      .def_prop_ro(
          "change_mm_rad", [](const FirstOrderResponse& r) { return if_done(r, r.change); },
          "From there to the final value.")
      .def_prop_ro("time_constant_s", [](const FirstOrderResponse& r) { return if_done(r, r.time_constant); })
      .def_prop_ro(
          "uncertainty_s", [](const FirstOrderResponse& r) { return if_done(r, r.uncertainty); },
          "Standard uncertainty of time_constant_s.");
}

template <class Class, class Result>
void add_temperatures(Class& bound, std::vector<TimeSeries> Result::*temperatures) {
  bound.def_prop_ro(
      "temperatures",
      [=](const Result& r) {
        std::vector<SensorSeries> all;
        for (const TimeSeries& series : r.*temperatures) all.push_back({series, "degC"});
        return all;
      },
      "SensorSeries of the temperatures.");
}

void bind_thermal_results(nb::module_& module) {
  nb::class_<EtveEvaluation>(module, "EtveNumbers", "What the sensors read while only the environment changed.")
      .def_prop_ro(
          "sensors",
          [](const EtveEvaluation& e) {
            std::vector<SensorSeries> all;
            for (const EtveSensor& one : e.sensors) all.push_back(series_of(one.sensor));
            return all;
          },
          "SensorSeries of the displacements and angles, and of tilts from two planes.")
      .def_prop_ro(
          "temperatures",
          [](const EtveEvaluation& e) {
            std::vector<SensorSeries> all;
            for (const EtveTemperature& one : e.temperatures) all.push_back({one.series, "degC"});
            return all;
          },
          "SensorSeries of the temperatures.");
  nb::class_<SpindleDistortion> spindle(module, "SpindleDistortionNumbers",
                                        "What the sensors read at a rotating spindle. Lists are in the order of the "
                                        "sensors.");
  spindle
      .def_prop_ro(
          "sensors",
          [](const SpindleDistortion& d) {
            std::vector<SensorSeries> all;
            for (const WarmingSensor& one : d.sensors) all.push_back(series_of(one.sensor));
            return all;
          },
          "SensorSeries of the displacements and angles, and of tilts from two planes.")
      .def_prop_ro(
          "warming",
          [](const SpindleDistortion& d) {
            std::vector<FirstOrderResponse> all;
            for (const WarmingSensor& one : d.sensors) all.push_back(one.warming);
            return all;
          },
          "FirstOrderResponse of each sensor while the spindle rotates.")
      .def_prop_ro(
          "cooling",
          [](const SpindleDistortion& d) {
            std::vector<FirstOrderResponse> all;
            for (const WarmingSensor& one : d.sensors) all.push_back(one.recovery);
            return all;
          },
          "FirstOrderResponse of each sensor after the stop.")
      .def_prop_ro("start_s", [](const SpindleDistortion& d) { return d.run.start; })
      .def_prop_ro("stop_s", [](const SpindleDistortion& d) { return d.run.stop; });
  add_temperatures(spindle, &SpindleDistortion::temperatures);
  nb::class_<AxisExpansion>(module, "AxisExpansion", "Change of the distance of the outer targets.")
      .def_ro("direction", &AxisExpansion::approach, "'+' or '-'; empty: the readings do not say.")
      .def_ro("length_mm", &AxisExpansion::length, "Nominal distance.")
      .def_prop_ro(
          "distance",
          [](const AxisExpansion& e) {
            return SensorSeries{e.distance, "mm"};
          },
          "SensorSeries of its change.")
      .def_ro("expansion", &AxisExpansion::expansion, "Relative expansion at the end, mm per mm.")
      .def_ro("expansion_uncertainty", &AxisExpansion::expansion_uncertainty, "Standard; 0 if not stated.")
      .def_ro("response", &AxisExpansion::response);
  nb::class_<AxisDistortion> axis(module, "AxisDistortionNumbers", "What was read at the targets of a moving axis.");
  axis.def_prop_ro(
          "targets_mm",
          [](const AxisDistortion& d) {
            std::vector<double> all;
            for (const AxisTarget& one : d.targets) all.push_back(one.target);
            const std::size_t n = all.size();
            return array_of(std::move(all), {n});
          },
          nb::sig("def targets_mm(self) -> numpy.ndarray"), "[n], ascending; twice with two directions.")
      .def_prop_ro(
          "directions",
          [](const AxisDistortion& d) {
            std::vector<std::string> all;
            for (const AxisTarget& one : d.targets) all.push_back(one.approach);
            return all;
          },
          "[n] '+', '-' or empty.")
      .def_prop_ro(
          "sensors",
          [](const AxisDistortion& d) {
            std::vector<std::vector<SensorSeries>> all(d.targets.size());
            for (std::size_t i = 0; i < all.size(); ++i) {
              for (const AxisTargetSensor& one : d.targets[i].sensors) all[i].push_back(series_of(one.sensor));
            }
            return all;
          },
          "SensorSeries at each target, the deviation first.")
      .def_ro("expansions", &AxisDistortion::expansions, "AxisExpansion of each direction.");
  add_temperatures(axis, &AxisDistortion::temperatures);
}

}  // namespace

void bind_thermal_tests(nb::module_& module) {
  bind_thermal_parts(module);
  bind_thermal_results(module);
  module.def(
      "evaluate_etve", &etve, nb::arg("readings"), nb::kw_only(), nb::arg("options") = OptionNumbers{},
      nb::arg("tolerances") = Tolerances{}, nb::arg("file") = "",
      "Environmental temperature variation error (ISO 230-3), as an Evaluation.\n\n"
      "readings: a file, or columns [n] in the order of time: time_min (or time_s, time_h), and one column per sensor\n"
      "with a name of its own, such as X1_um or Z_mm (displacements), A_urad (angles), air_degC (temperatures); NaN: "
      "not\n"
      "read then. options: numbers named like the options of the command, such as {'plane_distance_mm': 150,\n"
      "'u_reading_um': 0.1}; with 'length_mm' and coefficients of expansion also the uncertainty of a length by\n"
      "temperature. numbers is an EtveNumbers. Raises InputError. Definitions: docs/evaluate-thermal.md.\n\n"
      ">>> import abbe\n"
      ">>> result = abbe.evaluate_etve({'time_h': [0, 0.5, 1, 1.5], 'Z_um': [0, 2, 3, 1], 'air_degC': [20, 21, 22, "
      "22]})\n"
      ">>> result['ETVE_Z'].value, result['ETVE1h_Z'].value, result['rate_air'].value\n"
      "(3.0, 3.0, 2.0)\n");
  module.def(
      "evaluate_spindle_distortion", &spindle_distortion, nb::arg("readings"), nb::kw_only(),
      nb::arg("options") = OptionNumbers{}, nb::arg("tolerances") = Tolerances{}, nb::arg("file") = "",
      "Thermal distortion by a rotating spindle (ISO 230-3), as an Evaluation.\n\n"
      "readings as for evaluate_etve(). options: {'start_min': 0, 'stop_min': 240}: when the spindle begins to rotate\n"
      "and stops, by the time of the readings; 'plane_distance_mm', 'u_reading_um', 'u_reading_urad'. numbers is a\n"
      "SpindleDistortionNumbers. Raises InputError. Definitions: docs/evaluate-thermal.md.");
  module.def(
      "evaluate_axis_distortion", &axis_distortion, nb::arg("readings"), nb::kw_only(),
      nb::arg("options") = OptionNumbers{}, nb::arg("tolerances") = Tolerances{}, nb::arg("file") = "",
      "Thermal distortion by a moving linear axis (ISO 230-3), as an Evaluation.\n\n"
      "readings: a file, or columns [n] in the order of time: time_min, target_mm, deviation_um (actual minus target) "
      "or\n"
      "actual_mm, and optionally direction ('+', '-') and columns of other sensors as for evaluate_etve(). options:\n"
      "{'u_reading_um': 0.1, 'u_reading_urad': 0.5}. numbers is an AxisDistortionNumbers. Raises InputError.\n"
      "Definitions: docs/evaluate-thermal.md.");
}

}  // namespace abbe::python
