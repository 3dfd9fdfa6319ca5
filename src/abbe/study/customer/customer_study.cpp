#include "abbe/study/customer/customer_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "abbe/formats/files/results_files.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/identify/trust/prediction.h"
#include "abbe/machine/axis_unit.h"
#include "abbe/report/customer/calibration_certificate.h"
#include "abbe/report/customer/customer_words.h"
#include "abbe/report/customer/local_numbers.h"
#include "abbe/report/customer/quality_results.h"
#include "abbe/report/evaluations/partial_errors.h"
#include "abbe/study/comparison/compared_campaigns.h"
#include "abbe/study/customer/customer_errors.h"
#include "abbe/study/customer/customer_states.h"
#include "abbe/study/identification/trust.h"
#include "abbe/study/report/summary.h"

namespace abbe {
namespace {

using Word = CustomerWord;

constexpr const char* kLargestVolumetric = "V_max";
constexpr const char* kMeanVolumetric = "V_mean";

/// "EXX_um" of a figure whose unit is shown as "µm".
std::string tolerance_name(const std::string& symbol, bool angle) { return symbol + "_" + micro_unit(angle); }

CustomerErrors identified_errors(const Study& study, const StudyResult& result) {
  ErrorsFile file = errors_for_customer(study.machine, identified_for_customer(study, result));
  return {study.machine, std::move(file.errors), std::move(file.covariance), study.report.facts->language};
}

CustomerErrors earlier_errors(const Study& study, const EarlierResult& before) {
  ErrorsFile file = before.errors;
  file.covariance = covariance_of(file);
  file = errors_for_customer(study.machine, std::move(file));
  return {study.machine, std::move(file.errors), std::move(file.covariance), study.report.facts->language};
}

/// Of the poses, the largest with its expanded uncertainty, and the mean; um. In two states, the second without values.
/// @param poses  over which both are stated
/// @param is_incomplete  the uncertainty does not cover all errors of the machine
std::vector<CustomerFigure> volumetric_customer_figures(const CustomerErrors& of, const StatedPoses& poses,
                                                        bool is_incomplete, int threads) {
  ParameterCovariance covariance;
  covariance.covariance = of.covariance;
  for (std::size_t p = 0; p < of.errors.parameter_count(); ++p) covariance.parameters.push_back(p);
  const bool is_uncertain = of.covariance.size() > 0;
  ErrorMapOptions options;
  options.orientation = false;
  options.remove_rigid_motion = true;
  options.covariance = is_uncertain ? &covariance : nullptr;
  options.threads = threads;
  const ErrorMap map = error_map(of.machine, of.errors, nullptr, pose_source(poses.poses), options);
  if (map.statistics.count == 0) return {};
  std::size_t largest = 0;
  for (std::size_t k = 0; k < map.count(); ++k) {
    if (map.covered[k] != 0 && (map.covered[largest] == 0 || map.norm[k] > map.norm[largest])) largest = k;
  }
  std::optional<double> expanded;
  if (is_uncertain) expanded = 2e3 * map.norm_uncertainty[largest];
  CustomerFigure most, mean;
  most.symbol = kLargestVolumetric;
  most.name = customer_word(Word::volumetric_largest, of.language);
  most.states = {{1e3 * map.norm[largest], expanded, is_incomplete}, {}};
  mean.symbol = kMeanVolumetric;
  mean.name = customer_word(Word::volumetric_mean, of.language);
  mean.states = {{1e3 * map.statistics.mean, std::nullopt, is_incomplete}, {}};
  std::vector<CustomerFigure> figures = {most, mean};
  for (CustomerFigure& figure : figures) figure.unit = "µm", figure.decimals = decimals_for(expanded.value_or(0));
  return figures;
}

/// Poses in the range that both results know; those of the volumetric figures where there is none before.
StatedPoses poses_of(const Study& study, const StudyResult& result) {
  std::vector<const ErrorSet*> known = {&result.identification.errors};
  if (result.campaign.truth) known.push_back(&*result.campaign.truth);
  if (result.before) known.push_back(&result.before->errors.errors);
  return stated_grid(study.machine, known);
}

/// All figures of the machine as measured, with what is predicted to remain.
std::vector<CustomerFigure> measured_figures(const Study& study, const StudyResult& result) {
  const CustomerErrors now = identified_errors(study, result);
  std::vector<CustomerFigure> figures =
      volumetric_customer_figures(now, poses_of(study, result), !prediction_covers(result).empty(), study.threads);
  if (!figures.empty() && result.volumetric && result.volumetric->predicted_after) {
    figures[0].states[1].value = 1e3 * result.volumetric->predicted_after->maximum;
    figures[1].states[1].value = 1e3 * result.volumetric->predicted_after->mean;
  }
  for (CustomerFigure& figure : customer_error_figures(now)) figures.push_back(std::move(figure));
  return figures;
}

/// Puts the figures before a correction in front, in place of what is predicted.
void add_figures_before(const Study& study, const StudyResult& result, std::vector<CustomerFigure>& figures) {
  const CustomerErrors then = earlier_errors(study, *result.before);
  const bool is_incomplete = partial_errors(study.machine, result.before->errors).is_partial();
  std::vector<CustomerFigure> before =
      volumetric_customer_figures(then, poses_of(study, result), is_incomplete, study.threads);
  for (CustomerFigure& figure : customer_error_figures(then)) before.push_back(std::move(figure));
  for (CustomerFigure& figure : figures) {
    CustomerValue value;
    for (const CustomerFigure& earlier : before) {
      if (earlier.symbol == figure.symbol) value = earlier.states[0];
    }
    figure.states = {value, figure.states[0]};
  }
}

std::vector<std::string> notes_of(const Study& study, const StudyResult& result) {
  std::vector<std::string> notes;
  if (result.before) {
    for (const std::string& reason : result.before->errors.distrusted) {
      notes.push_back("before: not to be trusted: " + reason);
    }
  }
  if (result.usable()) {
    notes.push_back(study_verdict(study, result));
    for (std::string& note : customer_state_notes(study.machine, identified_for_customer(study, result)))
      notes.push_back(std::move(note));
  }
  for (const std::string& warning : study_warnings(study, result)) notes.push_back(warning);
  if (result.map && result.map->before.statistics.excluded > 0) notes.push_back(left_out_words(result.map->left_out()));
  if (!result.not_identified.errors.empty()) {
    notes.push_back(
        fmt::format("Not identified and taken as zero: {}.", not_identified_names(study, result.not_identified)));
  }
  return notes;
}

std::vector<std::string> files_of(const Study& study, const StudyResult& result) {
  std::vector<std::string> files = {study.machine_file.filename().string()};
  if (result.before) files.push_back(result.before->name);
  for (const ChannelFile& channel : study.channels.files) files.push_back(channel.file.filename().string());
  for (const Setup& setup : study.setups) {
    for (const SetupData& data : setup.data) {
      if (!data.file.empty()) files.push_back(data.file.filename().string());
    }
    for (const ChannelFile& channel : setup.channels.files) files.push_back(channel.file.filename().string());
  }
  return files;
}

/// Without what is predicted, which is no measurement.
CustomerReport measured_customer_report(const Study& study, const StudyResult& result) {
  CustomerReport report = study_customer_report(study, result);
  if (result.before) return report;
  report.states.resize(1);
  for (CustomerFigure& figure : report.figures) figure.states.resize(1);
  return report;
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
  if (!study.report.facts) {
    if (!study.report.before) return;
    throw InputError({.field = "before"}, "is of a customer report, whose facts are missing",
                     "customer, machine, date and others in [report]");
  }
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

EarlierResult read_earlier_result(const Study& study) {
  const std::string path = study.report.before->string();
  const IdentifiedCampaign campaign = read_campaign(path, study.machine, StatesOfErrors::allowed);
  EarlierResult before{campaign.name, campaign.errors};
  if (is_results_folder(path)) {
    const std::string summary = results_summary_text(path);
    const nlohmann::json json = nlohmann::json::parse(summary, nullptr, false);
    before.is_simulated = json.is_object() && json.contains("true_volumetric_error");
  }
  return before;
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
  report.states = customer_states(study, result, is_refused, language);
  if (!result.usable()) report.refusals.push_back(study_verdict(study, result));
  for (const Distrust& reason : result.distrusted) {
    (is_refused ? report.refusals : report.notes).push_back("Not to be trusted: " + reason.text + ".");
  }
  if (result.usable()) {
    report.figures = measured_figures(study, result);
    if (result.before) add_figures_before(study, result, report.figures);
    for (const ReportTolerance& tolerance : report.facts.tolerances) {
      for (CustomerFigure& figure : report.figures) {
        if (tolerance.name == tolerance_name(figure.symbol, figure.unit == "µrad")) figure.tolerance = tolerance.value;
      }
    }
    const CustomerErrors now = identified_errors(study, result);
    report.tables = customer_error_tables(now);
    report.drawings = customer_error_drawings(now);
    report.explanations = {word(Word::range_note), word(Word::convention_note)};
    if (!result.before) report.explanations.push_back(word(Word::predicted_note));
  }
  for (std::string& note : notes_of(study, result)) report.notes.push_back(std::move(note));
  report.files = files_of(study, result);
  return report;
}

std::string study_qif_results(const Study& study, const StudyResult& result) {
  return qif_results(measured_customer_report(study, result));
}

std::string study_certificate(const Study& study, const StudyResult& result) {
  // At the state at which the figures hold: nothing is per unit of a state that the certificate cannot name.
  CustomerErrors certified = identified_errors(study, result);
  const ErrorSet& identified = certified.errors;
  CertifiedErrors errors;
  errors.names = parameter_names(study.machine, identified);
  errors.is_angle = parameters_are_angles(study.machine, identified);
  errors.values = identified.parameters();
  errors.covariance = std::move(certified.covariance);
  for (std::size_t i = 0; i < errors.values.size(); ++i) {
    const double scale = micro_per_unit(errors.is_angle[i]);
    errors.values[i] *= scale;
    errors.covariance.row(static_cast<Eigen::Index>(i)) *= scale;
    errors.covariance.col(static_cast<Eigen::Index>(i)) *= scale;
    // Labels stand in a list, between blanks.
    std::replace(errors.names[i].begin(), errors.names[i].end(), ' ', '_');
  }
  return calibration_certificate(measured_customer_report(study, result), errors);
}

}  // namespace abbe
