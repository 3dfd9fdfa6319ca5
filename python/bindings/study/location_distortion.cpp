#include <nanobind/stl/map.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "abbe/study/campaign.h"
#include "abbe/study/evaluations/evaluation.h"
#include "bindings/arrays.h"
#include "bindings/evaluate/evaluations.h"
#include "bindings/evaluate/thermal_parts.h"
#include "bindings/study/study_objects.h"

namespace abbe::python {
namespace {

Evaluation location_distortion(const Study& study, const std::map<std::string, PythonReadings>& readings,
                               const MachineErrors* truth, const OptionNumbers& options, const Tolerances& tolerances,
                               const std::string& file) {
  LocationDistortionTest test;
  enter_numbers(options, location_distortion_numbers(), test);
  test.study = *study_with_data(study, readings, truth);
  test.campaign = computed([&] { return gather_readings(test.study); });
  return evaluate_test(std::move(test), file, tolerances);
}

template <class Value, class Part>
std::vector<Value> of_locations(const LocationDistortion& distortion, const Part& part) {
  std::vector<Value> all;
  for (const WarmingSensor& one : distortion.locations) all.push_back(part(one));
  return all;
}

}  // namespace

void add_location_distortion(nb::class_<Study>& bound) {
  bound.def("location_distortion", &location_distortion, nb::arg("readings"), nb::arg("truth").none(),
            nb::arg("options"), nb::arg("tolerances"), nb::arg("file"));
}

void bind_location_distortion(nb::module_& module) {
  nb::class_<LocationDistortion> bound(
      module, "LocationDistortionNumbers",
      "Location errors in every cycle of a test. Lists are in the order of the location errors.");
  bound
      .def_prop_ro(
          "locations",
          [](const LocationDistortion& d) {
            return of_locations<SensorSeries>(d, [](const WarmingSensor& one) { return series_of(one.sensor); });
          },
          "SensorSeries of the location errors, a value for each cycle at the mean time of its readings.")
      .def_prop_ro(
          "standard_uncertainties_mm_rad",
          [](const LocationDistortion& d) {
            return of_locations<double>(d, [](const WarmingSensor& one) { return one.sensor.reading_uncertainty; });
          },
          "Of one value, the largest of all cycles, by the noise of the readings.")
      .def_prop_ro(
          "warming",
          [](const LocationDistortion& d) {
            return of_locations<FirstOrderResponse>(d, [](const WarmingSensor& one) { return one.warming; });
          },
          "FirstOrderResponse of each location error while the machine is heated.")
      .def_prop_ro(
          "cooling",
          [](const LocationDistortion& d) {
            return of_locations<FirstOrderResponse>(d, [](const WarmingSensor& one) { return one.recovery; });
          },
          "FirstOrderResponse of each location error after the stop.")
      .def_ro("no_change", &LocationDistortion::no_change, "Probability of so large changes by noise alone.")
      .def_ro("misfit_probability", &LocationDistortion::misfit_probability,
              "Of so large a chi-square if nothing but the location errors changed; 1: nothing is known of it.")
      .def_ro("uncertainty_factor", &LocationDistortion::uncertainty_factor,
              "What the stated uncertainties were multiplied by: the root of chi-square / degrees of freedom, at least "
              "1.")
      .def_prop_ro("start_s", [](const LocationDistortion& d) { return d.run.start; })
      .def_prop_ro("stop_s", [](const LocationDistortion& d) { return d.run.stop; })
      .def_prop_ro(
          "temperatures",
          [](const LocationDistortion& d) {
            std::vector<SensorSeries> all;
            for (const TimeSeries& series : d.temperatures) all.push_back({series, "degC"});
            return all;
          },
          "SensorSeries of the measured temperatures, means of each cycle.");
}

}  // namespace abbe::python
