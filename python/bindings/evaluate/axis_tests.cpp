#include <fmt/format.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include "bindings/evaluate/evaluations.h"

namespace abbe::python {
namespace {

void enter_uncertainty(const std::map<std::string, double>& given, PositioningTest& test) {
  for (const auto& [name, value] : given) {
    const PositioningContribution& contribution = entry_named("uncertainty", name, positioning_contributions());
    if (!(value >= 0 && value <= kMostUm)) {
      throw InputError({.field = "uncertainty"}, fmt::format("{} is {}", name, value), "a number from 0 to 1e6");
    }
    (test.*contribution.axis).*contribution.value = value * contribution.unit;
  }
}

/// Temperatures, coefficients and their uncertainties, in the units of the options.
void enter_expansion(const std::map<std::string, double>& given, std::span<const TestNumber<ExpansionNumbers>> known,
                     ExpansionNumbers& numbers) {
  for (const auto& [name, value] : given) {
    const TestNumber<ExpansionNumbers>& number = entry_named("expansion", name, known);
    if (!(value >= number.from && value <= number.to)) {
      throw InputError({.field = "expansion"}, fmt::format("{} is {}", name, value),
                       fmt::format("a number from {:g} to {:g}", number.from, number.to));
    }
    numbers.*number.value = value;
  }
}

Evaluation positioning(const ReadingsArgument& argument, const std::map<std::string, double>& uncertainty,
                       const std::map<std::string, double>& expansion,
                       const std::optional<ReadingsArgument>& temperatures, const Tolerances& tolerances,
                       const std::string& file) {
  const GivenReadings given = given_readings(argument);
  PositioningTest test;
  test.readings = readings_of(
      given, [](const auto& path) { return read_positioning(path); },
      [](const NamedColumns& columns) { return parse_positioning(columns); });
  enter_uncertainty(uncertainty, test);
  enter_expansion(expansion, positioning_expansion_numbers(), test.expansion);
  if (temperatures) {
    test.temperatures = readings_of(
        given_readings(*temperatures, "temperatures"), [](const auto& path) { return read_temperature_record(path); },
        [](const NamedColumns& columns) { return parse_temperature_record(columns); });
  }
  return evaluate_test(std::move(test), name_of(given, file), tolerances);
}

Evaluation diagonals(const ReadingsArgument& argument, const Tolerances& tolerances, const std::string& file) {
  const GivenReadings given = given_readings(argument);
  DiagonalsTest test{readings_of(
      given, [](const auto& path) { return read_diagonals(path); },
      [](const NamedColumns& columns) { return parse_diagonals(columns); })};
  return evaluate_test(std::move(test), name_of(given, file), tolerances);
}

Evaluation circular(const ReadingsArgument& argument, double radius_mm, const std::optional<std::string>& plane,
                    const std::string& centre, double u_reading_um, double u_length_um, bool length_calibrated,
                    double skip_reversal_deg, std::optional<double> feed_mm_min,
                    const std::map<std::string, double>& expansion, const Tolerances& tolerances,
                    const std::string& file) {
  CircularTest test;
  enter_expansion(expansion, circular_expansion_numbers(), test.expansion);
  test.nominal_radius = quantity("radius_mm", radius_mm, Quantity::length, "mm", 0.001, 1e6);
  test.plane = plane.value_or("");
  test.centre = word_value<CircularCentre>("centre", centre,
                                           {{"least-squares", CircularCentre::least_squares},
                                            {"minimum-zone", CircularCentre::minimum_zone},
                                            {"instrument", CircularCentre::instrument}});
  test.reading_uncertainty = quantity("u_reading_um", u_reading_um, Quantity::length, "um", 0, kMostUm);
  test.length_uncertainty = quantity("u_length_um", u_length_um, Quantity::length, "um", 0, kMostUm);
  test.length_calibrated = length_calibrated;
  test.reversal_margin = quantity("skip_reversal_deg", skip_reversal_deg, Quantity::angle, "deg", 0, 40);
  if (feed_mm_min) test.feed = quantity("feed_mm_min", *feed_mm_min, Quantity::length, "mm", 0.001, 1e6) / 60;
  const GivenReadings given = given_readings(argument);
  const double radius = test.nominal_radius;
  test.readings = readings_of(
      given, [&](const auto& path) { return read_circular(path, radius); },
      [&](const NamedColumns& columns) { return parse_circular(columns, radius); });
  return evaluate_test(std::move(test), name_of(given, file), tolerances);
}

Evaluation rotation(const ReadingsArgument& argument, std::optional<double> plane_distance_mm, double sensitive_deg,
                    double u_reading_um, const Tolerances& tolerances, const std::string& file) {
  RotationTest test;
  if (plane_distance_mm) {
    test.options.plane_distance = quantity("plane_distance_mm", *plane_distance_mm, Quantity::length, "mm", 0.001, 1e6);
  }
  test.options.sensitive_angle = quantity("sensitive_deg", sensitive_deg, Quantity::angle, "deg", -360, 360);
  test.options.reading_uncertainty = quantity("u_reading_um", u_reading_um, Quantity::length, "um", 0, kMostUm);
  const GivenReadings given = given_readings(argument);
  test.readings = readings_of(
      given, [](const auto& path) { return read_rotation(path); },
      [](const NamedColumns& columns) { return parse_rotation(columns); });
  return evaluate_test(std::move(test), name_of(given, file), tolerances);
}

ReferenceLine reference_line(const std::string& reference) {
  return word_value<ReferenceLine>(
      "reference", reference,
      {{"least-squares", ReferenceLine::least_squares}, {"minimum-zone", ReferenceLine::minimum_zone}});
}

Evaluation of_one_line(const ReadingsArgument& argument, const std::string& reference, double u_reading_um,
                       const Tolerances& tolerances, const std::string& file) {
  StraightnessTest test;
  test.reference = reference_line(reference);
  test.reading_uncertainty = quantity("u_reading_um", u_reading_um, Quantity::length, "um", 0, kMostUm);
  const GivenReadings given = given_readings(argument);
  test.readings = readings_of(
      given, [](const auto& path) { return read_straightness(path); },
      [](const NamedColumns& columns) { return parse_straightness(columns); });
  return evaluate_test(std::move(test), name_of(given, file), tolerances);
}

Evaluation of_two_lines(const ReadingsArgument& argument, const std::string& reference, double u_reading_um,
                        double square_urad, double u_square_urad, const Tolerances& tolerances,
                        const std::string& file) {
  SquarenessTest test;
  test.options.reference = reference_line(reference);
  test.options.reading_uncertainty = quantity("u_reading_um", u_reading_um, Quantity::length, "um", 0, kMostUm);
  test.options.artefact = quantity("square_urad", square_urad, Quantity::angle, "urad", -1e5, 1e5);
  test.options.artefact_uncertainty = quantity("u_square_urad", u_square_urad, Quantity::angle, "urad", 0, 1e5);
  const GivenReadings given = given_readings(argument);
  test.readings = readings_of(
      given, [](const auto& path) { return read_squareness(path); },
      [](const NamedColumns& columns) { return parse_squareness(columns); });
  return evaluate_test(std::move(test), name_of(given, file), tolerances);
}

}  // namespace

void bind_axis_tests(nb::module_& module) {
  module.def(
      "evaluate_positioning", &positioning, nb::arg("readings"), nb::kw_only(),
      nb::arg("uncertainty") = std::map<std::string, double>{}, nb::arg("expansion") = std::map<std::string, double>{},
      nb::arg("temperatures") = nb::none(), nb::arg("tolerances") = Tolerances{}, nb::arg("file") = "",
      "Accuracy and repeatability of positioning of a linear or rotary axis (ISO 230-2), as an Evaluation.\n\n"
      "readings: a file, or columns [n] named as in one, of any unit: direction ('+', '-': from which side the target\n"
      "was approached), target_mm or target_deg, deviation_um (actual minus target) or actual_mm, or deviation_arcsec\n"
      "or actual_deg, and optionally run. uncertainty: contributions, named like the options of the command:\n"
      "{'instrument_um_per_m': 0.6, 'misalignment_mm': 1}; instruments and set-up expanded (k = 2).\n"
      "expansion: correction to 20 degC, named likewise: {'machine_temperature_degC': 23.5,\n"
      "'u_machine_temperature_K': 0.3}, with the coefficients in uncertainty; temperatures may also be columns\n"
      "(machine_degC, instrument_degC) of the readings, or of temperatures over time_min.\n"
      "tolerances: {'A_um': 10}. file: name for the title. numbers is a PositioningNumbers.\n"
      "Raises InputError naming the column and the row. Definitions: docs/evaluate.md.\n\n"
      ">>> import abbe\n"
      ">>> result = abbe.evaluate_positioning({\n"
      "...     'direction': ['+', '-'] * 4, 'target_mm': [0, 0, 0, 0, 100, 100, 100, 100],\n"
      "...     'deviation_um': [1, -1, 3, -1, 4, 5, 4, 7]}, tolerances={'E_um': 7})\n"
      ">>> result['E'].value, result['E'].unit, result['E'].verdict\n"
      "(7.0, 'um', 'within')\n"
      ">>> result.numbers.reversal_mm_rad.round(4).tolist()\n"
      "[0.003, -0.002]\n");
  module.def(
      "evaluate_diagonals", &diagonals, nb::arg("readings"), nb::kw_only(), nb::arg("tolerances") = Tolerances{},
      nb::arg("file") = "",
      "Positioning along body or face diagonals (ISO 230-6), as an Evaluation.\n\n"
      "readings: a file, or columns [n]: diagonal (a name such as '+X+Y+Z'), direction, target_mm (the distance along\n"
      "the diagonal), deviation_um or actual_mm, and optionally run. numbers is a DiagonalsNumbers. Raises "
      "InputError.\n"
      "Definitions: docs/evaluate.md.");
  module.def(
      "evaluate_circular", &circular, nb::arg("readings"), nb::arg("radius_mm"), nb::kw_only(),
      nb::arg("plane") = nb::none(), nb::arg("centre") = "least-squares", nb::arg("u_reading_um") = 0.0,
      nb::arg("u_length_um") = 0.0, nb::arg("length_calibrated") = true, nb::arg("skip_reversal_deg") = 0.0,
      nb::arg("feed_mm_min") = nb::none(), nb::arg("expansion") = std::map<std::string, double>{},
      nb::arg("tolerances") = Tolerances{}, nb::arg("file") = "",
      "Circular test (ISO 230-4) with a ball bar or grid encoder, and the causes of the deviations.\n\n"
      "readings: a file, or columns [n]: direction ('cw', 'ccw') with angle_deg and deviation_um (from the nominal\n"
      "radius) or radius_mm of a ball bar, or with two of X_mm, Y_mm, Z_mm of a grid encoder, from the centre of the\n"
      "nominal circle. radius_mm: nominal radius. plane: 'XY' (default), 'YZ' or 'ZX' of a ball bar; angles run from\n"
      "the first axis to the second. centre: 'least-squares', 'minimum-zone' or 'instrument'. u_reading_um,\n"
      "u_length_um: standard uncertainties of a reading, and of what all readings share. length_calibrated: if False, "
      "the\n"
      "length shows only the difference of the scales. skip_reversal_deg: readings this near a reversal are not used\n"
      "to find the causes. feed_mm_min: along the path. expansion: correction to 20 degC, named like the options of\n"
      "the command: {'machine_expansion_um_per_m_K': 10, 'machine_temperature_degC': 23}. numbers is a "
      "CircularNumbers. Raises InputError.\n"
      "Definitions: docs/evaluate-geometry.md.\n\n"
      ">>> import abbe, numpy\n"
      ">>> angle = numpy.arange(0, 360, 5.0)\n"
      ">>> ovality = 2 * numpy.sin(2 * numpy.radians(angle))  # um: squareness of 40 urad on a radius of 100 mm\n"
      ">>> result = abbe.evaluate_circular(\n"
      "...     {'direction': ['ccw'] * 72, 'angle_deg': angle, 'deviation_um': ovality}, 100)\n"
      ">>> round(result['G_ccw'].value, 2)\n"
      "4.0\n"
      ">>> result.numbers.counterclockwise.deviation_mm.shape\n"
      "(72,)\n");
  module.def(
      "evaluate_rotation", &rotation, nb::arg("readings"), nb::kw_only(), nb::arg("plane_distance_mm") = nb::none(),
      nb::arg("sensitive_deg") = 0.0, nb::arg("u_reading_um") = 0.0, nb::arg("tolerances") = Tolerances{},
      nb::arg("file") = "",
      "Error motions of a spindle or rotary table (ISO 230-7) from displacement probes.\n\n"
      "readings: a file, or columns [n] in the order of time: angle_deg of the axis and any of x1_um, y1_um (radial\n"
      "probes along X and Y), x2_um, y2_um (in a second plane), axial_um (on the axis), face_um (parallel to it at a\n"
      "radius). plane_distance_mm: from the first to the second plane, for the tilts. sensitive_deg: rotating "
      "sensitive\n"
      "direction at axis angle zero, from X towards Y. u_reading_um: standard uncertainty of a displacement. With "
      "fewer "
      "than\n"
      "four whole turns, refused says so. numbers is a RotationNumbers. Raises InputError.\n"
      "Definitions: docs/evaluate-geometry.md.");
  module.def(
      "evaluate_straightness", &of_one_line, nb::arg("readings"), nb::kw_only(), nb::arg("reference") = "least-squares",
      nb::arg("u_reading_um") = 0.0, nb::arg("tolerances") = Tolerances{}, nb::arg("file") = "",
      "Straightness error (ISO 230-1) by least squares and by the minimum zone.\n\n"
      "readings: a file, or columns [n]: position_mm along the line, deviation_um across it; at least "
      "three\n"
      "different positions. reference: 'least-squares' or 'minimum-zone', for the plot. u_reading_um: standard "
      "uncertainty of a\n"
      "deviation. numbers is a StraightnessNumbers. Raises InputError. Definitions: docs/evaluate-geometry.md.\n\n"
      ">>> import abbe\n"
      ">>> result = abbe.evaluate_straightness({'position_mm': [0, 1, 2, 3], 'deviation_um': [0, 1, 1, 0]})\n"
      ">>> result['straightness_mz'].value\n"
      "1.0\n");
  module.def(
      "evaluate_squareness", &of_two_lines, nb::arg("readings"), nb::kw_only(), nb::arg("reference") = "least-squares",
      nb::arg("u_reading_um") = 0.0, nb::arg("square_urad") = 0.0, nb::arg("u_square_urad") = 0.0,
      nb::arg("tolerances") = Tolerances{}, nb::arg("file") = "",
      "Squareness error (ISO 230-1) between two lines read against a reference square.\n\n"
      "readings: a file, or columns [n]: line (two names such as 'X' and 'Y'), position_mm along it, deviation_um\n"
      "across it, positive along the other line. reference: 'least-squares' or 'minimum-zone'. u_reading_um: standard\n"
      "uncertainty of a deviation. square_urad: angle of the reference square minus 90 degrees; u_square_urad: its\n"
      "standard uncertainty. numbers is a SquarenessNumbers. Raises InputError. Definitions:\n"
      "docs/evaluate-geometry.md.");
}

}  // namespace abbe::python
