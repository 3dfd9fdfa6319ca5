#include "abbe/study/customer_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "abbe/formats/text/input_error.h"
#include "abbe/identify/trust/prediction.h"
#include "abbe/machine/axis_unit.h"
#include "abbe/report/customer/calibration_certificate.h"
#include "abbe/report/customer/customer_words.h"
#include "abbe/report/customer/local_numbers.h"
#include "abbe/study/customer_errors.h"
#include "abbe/study/summary.h"
#include "abbe/study/trust.h"

namespace abbe {
namespace {

using Word = CustomerWord;

constexpr const char* kLargestVolumetric = "V_max";
constexpr const char* kMeanVolumetric = "V_mean";

/// "EXX_um" of a figure whose unit is shown as "µm".
std::string tolerance_name(const std::string& symbol, bool angle) { return symbol + "_" + micro_unit(angle); }

/// Largest and mean volumetric error as identified, and what is predicted to remain.
std::vector<CustomerFigure> volumetric_figures_of(const Study& study, const StudyResult& result) {
  if (!result.volumetric || !result.volumetric->predicted_before) return {};
  const VolumetricFigures& volumetric = *result.volumetric;
  const ErrorSet& identified = result.identification.errors;
  std::vector<const ErrorSet*> known = {&identified};
  if (result.campaign.truth) known.push_back(&*result.campaign.truth);
  const StatedPoses stated = stated_grid(study.machine, known);
  ParameterCovariance covariance;
  covariance.covariance = machine_covariance(result.identification, identified.parameter_count());
  for (std::size_t p = 0; p < identified.parameter_count(); ++p) covariance.parameters.push_back(p);
  ErrorMapOptions options;
  options.orientation = false;
  options.remove_rigid_motion = true;
  options.covariance = &covariance;
  options.threads = study.threads;
  const ErrorMap map = error_map(study.machine, identified, nullptr, pose_source(stated.poses), options);
  std::size_t largest = 0;
  for (std::size_t k = 0; k < map.count(); ++k) {
    if (map.covered[k] != 0 && (map.covered[largest] == 0 || map.norm[k] > map.norm[largest])) largest = k;
  }
  const ReportLanguage language = study.report.facts->language;
  const bool is_incomplete = !prediction_covers(result).empty();
  const double expanded = 2e3 * map.norm_uncertainty[largest];
  const int decimals = decimals_for(expanded);
  const auto after = [&](double SampleStatistics::*statistic) {
    CustomerValue value;
    if (volumetric.predicted_after) value.value = 1e3 * (*volumetric.predicted_after).*statistic;
    return value;
  };
  CustomerFigure most, mean;
  most.symbol = kLargestVolumetric;
  most.name = customer_word(Word::volumetric_largest, language);
  most.states = {{1e3 * map.norm[largest], expanded, is_incomplete}, after(&SampleStatistics::maximum)};
  mean.symbol = kMeanVolumetric;
  mean.name = customer_word(Word::volumetric_mean, language);
  mean.states = {{1e3 * volumetric.predicted_before->mean, std::nullopt, is_incomplete},
                 after(&SampleStatistics::mean)};
  std::vector<CustomerFigure> figures = {most, mean};
  for (CustomerFigure& figure : figures) figure.unit = "µm", figure.decimals = decimals;
  return figures;
}

std::vector<std::string> notes_of(const Study& study, const StudyResult& result) {
  std::vector<std::string> notes;
  if (result.usable()) notes.push_back(study_verdict(study, result));
  for (const std::string& warning : study_warnings(study, result)) notes.push_back(warning);
  if (result.map && result.map->before.statistics.excluded > 0) notes.push_back(left_out_words(result.map->left_out()));
  if (!result.not_identified.errors.empty()) {
    notes.push_back(
        fmt::format("Not identified and taken as zero: {}.", not_identified_names(study, result.not_identified)));
  }
  return notes;
}

std::vector<std::string> files_of(const Study& study) {
  std::vector<std::string> files = {study.machine_file.filename().string()};
  for (const Setup& setup : study.setups) {
    for (const SetupData& data : setup.data) {
      if (!data.file.empty()) files.push_back(data.file.filename().string());
    }
  }
  return files;
}

}  // namespace

std::vector<std::string> customer_tolerance_names(const Study& study) {
  std::vector<std::string> names = {tolerance_name(kLargestVolumetric, false), tolerance_name(kMeanVolumetric, false)};
  if (!study.identification) return names;
  const auto add = [&](const std::string& name) {
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  };
  const Machine& machine = study.machine;
  for (const IdentifiedMotion& motion : study.identification->motions) {
    add(tolerance_name(error_motion_name(machine, motion.axis, motion.component), is_rotation(motion.component)));
  }
  for (const IdentifiedLocation& location : study.identification->locations) {
    add(tolerance_name(location_error_name(machine, location.axis, location.component),
                       is_rotation(location.component)));
  }
  for (const std::size_t axis : study.identification->reversals) {
    add(tolerance_name(reversal_name(machine, axis), machine.axes[axis].kind == AxisKind::rotary));
  }
  return names;
}

void check_customer_report(const Study& study) {
  if (!study.report.facts) return;
  if (!study.identification) {
    throw InputError({.field = "report"}, "there is nothing to report to a customer", "a study with [identify]");
  }
  const std::vector<std::string> names = customer_tolerance_names(study);
  for (const ReportTolerance& tolerance : study.report.facts->tolerances) {
    if (std::find(names.begin(), names.end(), tolerance.name) != names.end()) continue;
    std::string known;
    for (const std::string& name : names) known += (known.empty() ? "" : ", ") + name;
    throw InputError(tolerance.place, "there is no such figure in this unit", "one of " + known);
  }
  if (study.report.facts->laboratory.empty()) return;
  const std::vector<std::string> missing = missing_for_certificate(*study.report.facts);
  if (missing.empty()) return;
  throw InputError({.field = "report"},
                   fmt::format("with a laboratory, it asks for a calibration certificate, which also needs {}",
                               fmt::join(missing, ", ")),
                   "these facts, or no laboratory");
}

CustomerReport study_customer_report(const Study& study, const StudyResult& result) {
  CustomerReport report;
  report.facts = *study.report.facts;
  const ReportLanguage language = report.facts.language;
  const auto word = [&](Word what) { return std::string(customer_word(what, language)); };
  report.subject = word(Word::geometry);
  report.standard = "ISO 230-1:2012";
  if (std::any_of(study.machine.axes.begin(), study.machine.axes.end(),
                  [](const Axis& axis) { return axis.kind == AxisKind::rotary; })) {
    report.standard += ", ISO 230-7:2015";
  }
  report.is_simulated = result.campaign.truth.has_value();
  const bool is_refused = !result.usable() || (!result.distrusted.empty() && !result.misfit_accepted);
  report.states = {{word(Word::measured), is_refused            ? word(Word::without_trust)
                                          : report.is_simulated ? word(Word::without_simulation)
                                                                : ""},
                   {word(Word::predicted_after), word(Word::without_measurement)}};
  if (!result.usable()) report.refusals.push_back(study_verdict(study, result));
  for (const Distrust& reason : result.distrusted) {
    (is_refused ? report.refusals : report.notes).push_back("Not to be trusted: " + reason.text + ".");
  }
  if (result.usable()) {
    report.figures = volumetric_figures_of(study, result);
    for (CustomerFigure& figure : customer_error_figures(study, result)) report.figures.push_back(std::move(figure));
    for (const ReportTolerance& tolerance : report.facts.tolerances) {
      for (CustomerFigure& figure : report.figures) {
        if (tolerance.name == tolerance_name(figure.symbol, figure.unit == "µrad")) figure.tolerance = tolerance.value;
      }
    }
    report.tables = customer_error_tables(study, result);
    report.drawings = customer_error_drawings(study, result);
    report.explanations = {word(Word::range_note), word(Word::convention_note), word(Word::predicted_note)};
  }
  for (std::string& note : notes_of(study, result)) report.notes.push_back(std::move(note));
  report.files = files_of(study);
  return report;
}

std::string study_certificate(const Study& study, const StudyResult& result) {
  const ErrorSet& identified = result.identification.errors;
  CertifiedErrors errors;
  errors.names = parameter_names(study.machine, identified);
  errors.is_angle = parameters_are_angles(study.machine, identified);
  errors.values = identified.parameters();
  errors.covariance = machine_covariance(result.identification, identified.parameter_count());
  for (std::size_t i = 0; i < errors.values.size(); ++i) {
    const double scale = micro_per_unit(errors.is_angle[i]);
    errors.values[i] *= scale;
    errors.covariance.row(static_cast<Eigen::Index>(i)) *= scale;
    errors.covariance.col(static_cast<Eigen::Index>(i)) *= scale;
    // Labels stand in a list, between blanks.
    std::replace(errors.names[i].begin(), errors.names[i].end(), ' ', '_');
  }
  CustomerReport report = study_customer_report(study, result);
  // A prediction is no measurement.
  report.states.resize(1);
  for (CustomerFigure& figure : report.figures) figure.states.resize(1);
  return calibration_certificate(report, errors);
}

}  // namespace abbe
