#include "abbe/study/identification/not_identified.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "abbe/errors/error_states.h"
#include "abbe/identify/parameter_words.h"
#include "abbe/identify/trust/shown_by.h"
#include "abbe/machine/coupling.h"
#include "abbe/study/study_result.h"
#include "abbe/verify/known_range.h"

namespace abbe {
namespace {

constexpr std::size_t kPoses = 250;
constexpr double kNothing_mm = 1e-6;

/// Poses at which errors are asked for their effect: random over where the identified ones are known.
PoseList poses_of(const Study& study, const ErrorSet& model) {
  std::vector<AxisRange> ranges;
  for (std::size_t i = 0; i < study.machine.axes.size(); ++i) ranges.push_back(known_range(study.machine, model, i, 2));
  PoseList poses = random_plan(study.machine, ranges, kPoses, study.seed * 7919);
  stand_at_references(study.machine, poses);
  return poses;
}

/// Root mean square over the poses of what errors make, the workpiece datum fitted.
double volumetric_rms(const Machine& machine, const ErrorSet& errors, const ErrorSet& without, const PoseList& poses) {
  ErrorMapOptions options;
  options.orientation = false;
  options.remove_rigid_motion = true;
  return error_map(machine, errors, &without, pose_source(poses), options).statistics.rms;
}

/// The study's problem with the errors added, at errors of zero; its priors keep their parameters.
struct ExtendedProblem {
  Problem problem;
  std::vector<std::vector<std::size_t>> groups;  ///< entries of the estimates of each added error
};

ExtendedProblem extended_problem(const Study& study, const StudyResult& result, const NotIdentified& found) {
  const Machine& machine = study.machine;
  const Problem& before = result.model.problem;
  std::vector<double> from, to;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const PositionLimits travel = position_limits(machine, i);
    from.push_back(travel.from);
    to.push_back(travel.to);
    for (const CampaignSetup& setup : result.campaign.setups) {
      for (const double position : positions_of_axis(machine, setup.poses(), i)) {
        from.back() = std::min(from.back(), position);
        to.back() = std::max(to.back(), position);
      }
    }
  }
  ErrorSet errors = errors_with(machine, before.errors, found.errors, from, to);
  errors.set_parameters(std::vector<double>(errors.parameter_count(), 0.0));
  ExtendedProblem extended;
  std::vector<std::shared_ptr<Observations>> observations;
  for (std::size_t s = 0; s < result.campaign.setups.size(); ++s) {
    observations.push_back(result.campaign.setups[s].observations(machine, errors));
    observations.back()->set_parameters(errors.parameters(), result.identification.setup[s]);
  }
  Problem& problem = extended.problem;
  problem = estimate_everything(machine, errors, observations);
  for (std::size_t s = 0; s < observations.size(); ++s) problem.observations[s].use = before.observations[s].use;

  // Motions of the model stay first, locations and the tool follow all motions.
  std::size_t old_motions = 0, all_motions = 0;
  for (const ErrorMotion& motion : before.errors.motions) old_motions += motion.coefficients.size();
  for (const ErrorMotion& motion : errors.motions) all_motions += motion.coefficients.size();
  const std::size_t old_locations = before.errors.locations.size();
  const std::size_t added_locations = errors.locations.size() - old_locations;
  const auto moved = [&](std::size_t index) {
    if (index < old_motions) return index;
    return index + all_motions - old_motions + (index < old_motions + old_locations ? 0 : added_locations);
  };
  std::vector<std::uint8_t> estimated(errors.parameter_count(), 0);
  for (const std::size_t index : before.machine_parameters) estimated[moved(index)] = 1;
  for (std::size_t p = old_motions; p < all_motions; ++p) estimated[p] = 1;
  for (std::size_t l = 0; l < added_locations; ++l) estimated[all_motions + old_locations + l] = 1;
  problem.machine_parameters.clear();
  for (std::size_t p = 0; p < estimated.size(); ++p) {
    if (estimated[p] != 0) problem.machine_parameters.push_back(p);
  }
  problem.priors = before.priors;
  for (Prior& prior : problem.priors) {
    if (prior.parameter.is_machine()) prior.parameter.index = moved(prior.parameter.index);
  }
  for (JointPrior prior : before.joint_priors) {
    const bool of_machine = std::all_of(prior.parameters.begin(), prior.parameters.end(),
                                        [](const ParameterId& id) { return id.is_machine(); });
    if (!of_machine) continue;
    for (ParameterId& id : prior.parameters) id.index = moved(id.index);
    problem.joint_priors.push_back(std::move(prior));
  }

  std::size_t next_motion = before.errors.motions.size(), next = old_motions;
  std::size_t next_location = all_motions + old_locations;
  for (const UnmodelledError& error : found.errors) {
    std::vector<std::size_t> group;
    if (error.is_location) {
      group.push_back(find_estimated(problem, {ParameterId::kMachine, next_location++}));
    } else {
      const Basis& basis = errors.motions[next_motion++].basis;
      for (std::size_t k = first_shape(basis); k < basis.size(); ++k) {
        group.push_back(find_estimated(problem, {ParameterId::kMachine, next + k}));
      }
      next += basis.size();
    }
    extended.groups.push_back(std::move(group));
  }
  return extended;
}

void add_remedies(const Study& study, const StudyResult& result, NotIdentified& found) {
  const ExtendedProblem extended = extended_problem(study, result, found);
  const std::vector<ShownBy> shown =
      shown_by(extended.problem, extended.groups, possible_measurements(extended.problem), {}, study.threads);
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const auto same = std::find_if(found.remedies.begin(), found.remedies.end(), [&](const NotIdentifiedRemedy& one) {
      return one.by_readings == shown[i].by_readings && one.remedy == shown[i].remedy;
    });
    if (same != found.remedies.end()) {
      same->errors.push_back(found.names[i]);
    } else {
      found.remedies.push_back({{found.names[i]}, shown[i].by_readings, shown[i].remedy});
    }
  }
  // What needs no measurement comes first.
  std::stable_partition(found.remedies.begin(), found.remedies.end(),
                        [](const NotIdentifiedRemedy& one) { return one.by_readings; });
}

std::string list_text(const std::vector<std::string>& parts) {
  std::string text;
  for (std::size_t i = 0; i < parts.size(); ++i) text += (i > 0 ? ", " : "") + parts[i];
  return text;
}

std::string remedy_text(const NotIdentifiedRemedy& one) {
  if (one.by_readings) return "the readings show it: identify it too";
  return one.remedy.empty() ? "none of the measurements tried would show it" : one.remedy;
}

}  // namespace

NotIdentified find_not_in_model(const Study& study, const ErrorSet& model) {
  const Machine& machine = study.machine;
  NotIdentified found;
  found.errors = unmodelled_errors(machine, model, pose_source(poses_of(study, model)));
  double square = 0;
  for (const UnmodelledError& error : found.errors) {
    square += error.effect * error.effect;
    found.names.push_back(error.is_location ? location_error_name(machine, error.axis, error.component)
                                            : error_motion_name(machine, error.axis, error.component));
  }
  found.usual = std::sqrt(square);
  return found;
}

NotIdentified find_not_identified(const Study& study, const StudyResult& result, bool advice) {
  const ErrorSet& model = result.model.problem.errors;
  NotIdentified found = find_not_in_model(study, model);
  if (found.errors.empty()) return found;
  if (result.campaign.truth) {
    const ErrorSet& truth = *result.campaign.truth;
    const PoseList poses = poses_of(study, model);
    found.actual = volumetric_rms(study.machine, truth, errors_without(truth, found.errors), poses);
  }
  if (advice) add_remedies(study, result, found);
  return found;
}

std::string not_identified_names(const Study& study, const NotIdentified& found) {
  std::vector<std::string> parts;
  for (std::size_t i = 0; i < found.errors.size(); ++i) {
    const UnmodelledError& error = found.errors[i];
    const bool whole =
        !error.is_location && i + kComponentCount <= found.errors.size() &&
        std::all_of(found.errors.begin() + static_cast<std::ptrdiff_t>(i),
                    found.errors.begin() + static_cast<std::ptrdiff_t>(i + kComponentCount),
                    [&](const UnmodelledError& one) { return !one.is_location && one.axis == error.axis; });
    if (whole) {
      parts.push_back("all six error motions of " + study.machine.axes[error.axis].name);
      i += kComponentCount - 1;
    } else {
      parts.push_back(found.names[i]);
    }
  }
  return list_text(parts);
}

std::string not_identified_text(const Study& study, const StudyResult& result) {
  const NotIdentified& found = result.not_identified;
  std::string text = fmt::format(
      "not identified: {}. They are taken as zero; the uncertainty of the volumetric error does not cover "
      "them. ",
      not_identified_names(study, found));
  if (result.campaign.truth) {
    text += found.actual < kNothing_mm
                ? std::string("The true ones are zero in this simulation, ")
                : fmt::format("The true ones make {:.3g} um of it (root mean square), ", 1e3 * found.actual);
  }
  const AdviceOptions usual;
  return text + fmt::format("{} of usual size ({:.0f} um, {:.0f} urad each) {} about {:.2g} um.",
                            result.campaign.truth ? "those" : "Errors", 1e3 * usual.typical_length,
                            1e6 * usual.typical_angle, result.campaign.truth ? "would make" : "there make",
                            1e3 * found.usual);
}

nlohmann::ordered_json not_identified_json(const Study& study, const StudyResult& result) {
  const NotIdentified& found = result.not_identified;
  nlohmann::ordered_json json;
  json["errors"] = found.names;
  std::vector<std::string> words;
  for (const UnmodelledError& error : found.errors) {
    words.push_back(error_words(study.machine, error.axis, error.component, error.is_location));
  }
  json["words"] = words;
  json["text"] = not_identified_text(study, result);
  json["usual_size_effect_um"] = 1e3 * found.usual;
  if (result.campaign.truth) json["true_effect_um"] = 1e3 * found.actual;
  json["shown_by"] = nlohmann::ordered_json::array();
  for (const NotIdentifiedRemedy& one : found.remedies) {
    json["shown_by"].push_back(
        {{"errors", one.errors}, {"by_these_readings", one.by_readings}, {"remedy", remedy_text(one)}});
  }
  return json;
}

std::string not_identified_remedies_text(const StudyResult& result) {
  std::string text;
  const NotIdentified& found = result.not_identified;
  if (found.errors.empty()) return text;
  text += "\nnot identified, and what would show it\n";
  for (const NotIdentifiedRemedy& one : found.remedies) {
    text += fmt::format("  {}: {}\n", list_text(one.errors), remedy_text(one));
  }
  return text;
}

}  // namespace abbe
