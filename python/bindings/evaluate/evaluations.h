#pragma once

#include <map>
#include <string>

#include "abbe/study/evaluations/evaluation.h"
#include "bindings/evaluate/readings.h"
#include "bindings/evaluate/report.h"
#include "bindings/use/arguments.h"

namespace abbe::python {

/// Evaluates a test without the GIL.
Evaluation evaluate_test(TestToEvaluate test, const std::string& file, const Tolerances& tolerances);

/// The name of readings for titles and messages.
std::string name_of(const GivenReadings& readings, const std::string& file);

/// read(path) for a file, parse(columns) for columns; without the GIL.
template <class Read, class Parse>
auto readings_of(const GivenReadings& given, const Read& read, const Parse& parse) {
  return computed([&] {
    if (const auto* const file = std::get_if<ReadingsFile>(&given)) return read(file->path);
    return parse(std::get<NamedColumns>(given));
  });
}

/// Classes of the numbers behind the reports, by kind of test.
void bind_axis_numbers(nb::module_& module);
void bind_circular_numbers(nb::module_& module);
void bind_contour_numbers(nb::module_& module);
/// Functions that evaluate tests of axes, and of curves and linkages.
void bind_axis_tests(nb::module_& module);
void bind_contour_tests(nb::module_& module);
/// Classes and functions of thermal tests.
void bind_thermal_tests(nb::module_& module);

}  // namespace abbe::python
