#include "abbe/study/evaluations/contour_tests.h"

#include <fmt/format.h>

#include <algorithm>
#include <regex>
#include <utility>

#include "abbe/formats/files/file_name.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/shapes/curve_file.h"
#include "abbe/formats/shapes/curve_pieces.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/report/evaluations/contour_report.h"
#include "abbe/study/evaluations/evaluated.h"

namespace abbe {
namespace {

/// "C2=12", "C30", "C2_deg": a command of an axis in a program or a column of one.
bool names_axis(const std::string& field) {
  static const std::regex axis("[A-EQ-RU-W][0-9]*([=_.+-].*)?");
  return std::regex_match(field, axis);
}

Curve read_curve_without_machine(const std::string& file) {
  try {
    return read_curve(file, Machine{});
  } catch (const InputError& error) {
    if (!names_axis(error.place().field)) throw;
    throw InputError(error.place(), "the command of an axis, and no machine is given",
                     "--machine with the machine file");
  }
}

std::string contour_title(const std::string& file) { return "Contour error of " + file_name(file); }

}  // namespace

std::vector<CommandPiece> read_commanded_pieces(const std::string& curve, const std::string& machine, bool closed) {
  if (!machine.empty()) return read_commanded_pieces(curve, read_machine(machine), closed);
  return commanded_pieces(read_curve_without_machine(curve), curve, closed ? "--closed" : "");
}

std::vector<CommandPiece> read_commanded_pieces(const std::string& curve, const Machine& machine, bool closed) {
  return commanded_pieces(read_curve(curve, machine), curve, closed ? "--closed" : "");
}

Evaluation evaluated(const SectionsTest& test, const std::string& file) {
  const std::vector<SectionReadings>& sections = test.readings;
  require_readings(!sections.empty(), file);
  const auto states_tilt = [](const SectionReadings& section) { return section.beam_tilt.has_value(); };
  if (test.beam_tilt && std::all_of(sections.begin(), sections.end(), states_tilt)) {
    throw InputError({.field = "--beam-tilt-deg"}, "has no effect: the file states the beam's tilt of every section",
                     "a file without the column beam_tilt");
  }
  SectionOptions options = test.options;
  options.edge.beam_tilt = test.beam_tilt.value_or(0);
  SectionsEvaluation found = evaluate_sections(sections, options);
  Evaluation result;
  result.report = section_report(contour_title(file), options, sections, found);
  if (found.refused > 0) {
    result.refused = fmt::format("{} of {} sections could not be evaluated", found.refused, sections.size());
  }
  result.found = std::move(found);
  return result;
}

Evaluation evaluated(const ContourPointsTest& test, const std::string& file) {
  if (test.pieces.empty()) throw InputError({.field = "--curve"}, "there is no curve", "one piece of it at least");
  const PointCloudFile& measured = test.readings;
  ContourPointsEvaluation found = evaluate_contour_points(test.pieces, measured.cloud.points, test.origin_uncertainty);
  Evaluation result;
  result.report = contour_points_report(contour_title(file), test.pieces, found);
  result.report.facts.front().second += ", " + cloud_words(measured);
  result.found = std::move(found);
  return result;
}

}  // namespace abbe
