#include "abbe/study/evaluations/linkage_tests.h"

#include <fmt/format.h>

#include "abbe/formats/files/file_name.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/identify/linkage/linkage_errors.h"
#include "abbe/report/evaluations/linkage_report.h"
#include "abbe/study/evaluations/evaluated.h"

namespace abbe {
namespace {

const char* convention_name(LinkageConvention convention) {
  return convention == LinkageConvention::table_moves ? "table-moves" : "head-moves";
}

/// The convention of a machine, which has all axes that the linkage needs.
LinkageConvention convention_of_machine(const LinkageTest& test) {
  for (const char* axis : {"X", "Y", "Z", "C1", "A"}) {
    if (test.machine->find_axis(axis) == Machine::npos) {
      throw InputError({.file = test.machine_file}, fmt::format("the machine has no axis {}", axis),
                       "axes X, Y, Z and a swing head C1, A, as in examples/machines/yin-engraver-u.machine.toml");
    }
  }
  const LinkageConvention convention = linkage_convention_of(*test.machine);
  if (test.convention && *test.convention != convention) {
    throw InputError({.field = std::string("--convention ") + convention_name(*test.convention)},
                     "is not what the machine's chain says",
                     fmt::format("{}, or without it", convention_name(convention)));
  }
  return convention;
}

void require_linkage(const LinkageEvaluation& found, const std::string& file) {
  if (found.status == LinkageStatus::ok) return;
  const bool circle =
      found.status == LinkageStatus::circle_reversed || found.status == LinkageStatus::circle_undetermined;
  throw InputError({file, 0, 0, circle ? "turn" : "width"}, found.reason,
                   circle ? "turn_deg: the angle by which the focus has turned about the axis of the table, seen from "
                            "the board, counter-clockwise from above, at two angles or more"
                          : "width_um at four or more positions Z_mm, on both sides of the focus");
}

/// Options of the uncertainties that are not stated: "--u-x-um, --u-y-um".
std::string taken_as_exact(const LinkageAccuracy& accuracy) {
  std::string exact;
  for (const LinkageAccuracyName& each : linkage_accuracy_names()) {
    if (accuracy.*each.value > 0) continue;
    exact += (exact.empty() ? "" : ", ") + std::string(each.option);
  }
  return exact;
}

bool states_any(const LinkageAccuracy& accuracy) {
  for (const LinkageAccuracyName& each : linkage_accuracy_names()) {
    if (accuracy.*each.value > 0) return true;
  }
  return false;
}

}  // namespace

const std::array<LinkageAccuracyName, 12>& linkage_accuracy_names() {
  static constexpr std::array<LinkageAccuracyName, 12> names = {{
      {"--u-x-um", Quantity::length, "um", &LinkageAccuracy::x, "a position of X"},
      {"--u-y-um", Quantity::length, "um", &LinkageAccuracy::y, "a position of Y"},
      {"--u-z-um", Quantity::length, "um", &LinkageAccuracy::z, "a position of Z"},
      {"--u-a-arcsec", Quantity::angle, "arcsec", &LinkageAccuracy::a, "a position of A"},
      {"--u-c1-arcsec", Quantity::angle, "arcsec", &LinkageAccuracy::c1, "a position of C1"},
      {"--u-c2-arcsec", Quantity::angle, "arcsec", &LinkageAccuracy::c2, "a position of C2"},
      {"--u-zero-a-arcsec", Quantity::angle, "arcsec", &LinkageAccuracy::zero_a, "the zero of A (step 1)"},
      {"--u-zero-c1-arcsec", Quantity::angle, "arcsec", &LinkageAccuracy::zero_c1, "the zero of C1 (step 1)"},
      {"--u-mark-um", Quantity::length, "um", &LinkageAccuracy::microscope, "a place read by the microscope"},
      {"--u-width-um", Quantity::length, "um", &LinkageAccuracy::width, "a width"},
      {"--u-exit-to-axis-um", Quantity::length, "um", &LinkageAccuracy::exit_to_axis, "--exit-to-axis-mm"},
      {"--u-board-um", Quantity::length, "um", &LinkageAccuracy::thickness, "--board-mm"},
  }};
  return names;
}

Evaluation evaluated(const LinkageTest& test, const std::string& file) {
  LinkageReadings readings = test.readings;
  readings.convention =
      test.machine ? convention_of_machine(test) : test.convention.value_or(LinkageConvention::table_moves);
  LinkageEvaluation found = evaluate_linkage(readings, test.accuracy);
  require_linkage(found, file);
  const bool stated = states_any(test.accuracy);
  std::optional<LinkageErrors> errors;
  if (test.machine) errors = linkage_errors(*test.machine, readings.convention, found.linkage, found.covariance);
  Evaluation result;
  result.report = linkage_report("Linkage of " + file_name(file), readings, found, stated,
                                 test.machine ? &*test.machine : nullptr, errors ? &*errors : nullptr);
  const std::string exact = taken_as_exact(test.accuracy);
  if (!exact.empty()) result.report.notes.push_back("Not stated, taken as exact: " + exact + ".");
  if (errors) {
    const ErrorsFile contents{errors->errors, errors->covariance, {{"method", "five steps of a laser engraver"}}};
    result.files = {{"errors.toml", errors_text(*test.machine, contents, stated ? "errors.covariance.csv" : "")}};
    if (stated) result.files.emplace_back("errors.covariance.csv", covariance_text(*test.machine, contents));
  }
  result.found = std::move(found);
  return result;
}

}  // namespace abbe
