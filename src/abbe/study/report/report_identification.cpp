#include "abbe/study/report/report_identification.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "abbe/report/evaluations/machine_json.h"
#include "abbe/study/report/coverage.h"

namespace abbe {
namespace {

const char* strategy_name(Strategy strategy) {
  constexpr const char* kNames[] = {"joint", "independent", "combined"};
  return kNames[static_cast<int>(strategy)];
}

const char* loss_name(LossKind loss) {
  constexpr const char* kNames[] = {"least squares", "Huber", "Cauchy", "Tukey"};
  return kNames[static_cast<int>(loss)];
}

nlohmann::ordered_json gauge_json(const Identification& identified) {
  nlohmann::ordered_json gauge = nlohmann::ordered_json::array();
  for (const GaugeConstraint& constraint : identified.gauge.constraints) {
    std::vector<std::string> names;
    for (std::size_t p : constraint.inseparable) names.push_back(identified.parameters[p].name);
    nlohmann::ordered_json entry = {
        {"parameters", names}, {"text", constraint.inseparable_words}, {"convention", constraint.words}};
    if (!constraint.by_convention) entry["by_convention"] = false;
    gauge.push_back(entry);
  }
  return gauge;
}

nlohmann::ordered_json history_json(const Identification& identified) {
  std::vector<double> cost, step, damping;
  std::vector<int> iteration;
  for (const IterationRecord& record : identified.history) {
    iteration.push_back(static_cast<int>(iteration.size()));
    cost.push_back(for_drawing(2 * record.cost));
    step.push_back(for_drawing(record.step));
    damping.push_back(for_drawing(record.damping));
  }
  return {{"iteration", iteration}, {"chi_square", cost}, {"relative_step", step}, {"damping", damping}};
}

nlohmann::ordered_json orders_json(const StudyResult& result) {
  const OrderSelection& selection = *result.order_selection;
  nlohmann::ordered_json orders;
  std::vector<std::string> labels;
  nlohmann::ordered_json held_out = nlohmann::ordered_json::array();
  int chosen = -1;
  for (const OrderTrial& trial : selection.trials) {
    std::string label;
    for (std::size_t g = 0; g < trial.orders.size() && g < result.model.order_groups.size(); ++g) {
      label += fmt::format("{}{} {}", g == 0 ? "" : ", ", result.model.order_groups[g].name, trial.orders[g]);
    }
    if (selection.done && trial.orders == selection.orders) chosen = static_cast<int>(labels.size());
    labels.push_back(label);
    held_out.push_back(nullptr);  // not identified
    if (trial.held_out_rms > 0) held_out.back() = for_drawing(trial.held_out_rms);
  }
  orders["label"] = labels;
  orders["held_out_normalised_rms"] = held_out;
  if (chosen >= 0) orders["chosen"] = chosen;
  return orders;
}

nlohmann::ordered_json stages_json(const StudyResult& result) {
  nlohmann::ordered_json stages = nlohmann::ordered_json::array();
  for (const Identification& stage : result.stages) {
    stages.push_back({{"status", status_text(stage.status)},
                      {"parameters", stage.parameters.size()},
                      {"residuals", stage.statistics.residual_count},
                      {"degrees_of_freedom", stage.statistics.degrees_of_freedom},
                      {"chi_square", stage.statistics.chi_square}});
  }
  return stages;
}

/// What is taken as the uncertainty of the readings of one set-up.
std::string noise_words(const Setup& setup) {
  if (setup.noise_from_data) {
    return fmt::format("{}: standard uncertainties of the readings as the data state them.", setup.name);
  }
  const std::string noise = setup.device->noise_words();
  if (noise.empty()) {
    return fmt::format(
        "{}: standard uncertainty of a reading as the study states it for this {}, independent from "
        "reading to reading.",
        setup.name, setup.instrument);
  }
  return fmt::format("{}: standard uncertainty of a reading {}, independent from reading to reading.", setup.name,
                     noise);
}

const char* common_noise_of(const VarianceComponents& components) {
  return components.estimated.by_block ? "Noise of a block of time (a displacement common to all readings in it)"
                                       : "Pose noise (a displacement common to all readings at one pose)";
}

/// What was found about the variances of the readings, and what that means.
void variance_assumptions(const StudyResult& result, std::vector<std::string>& list) {
  const VarianceComponents& components = result.weighed->components;
  list.emplace_back(
      "Residual = (measured - modelled) / standard uncertainty as stated. The variances of the readings are estimated "
      "from the residuals by restricted maximum likelihood, and the uncertainties of the result follow from them.");
  if (components.estimated.variance_factor) {
    list.push_back(fmt::format(
        "Variance factor of the stated uncertainties: {:.4g}, standard uncertainty {:.2g}. Chi-square then equals the "
        "degrees of freedom and is not a test of the model.",
        components.variance.factor, components.variance_factor_uncertainty()));
  }
  if (components.pose_noise_at_zero) {
    list.push_back(fmt::format("{}: none found, not above {:.3g} um (k = 2).", common_noise_of(components),
                               1e3 * components.pose_noise_uncertainty()));
  } else if (components.estimated.pose_noise) {
    list.push_back(fmt::format(
        "{}: {:.4g} um in every direction, standard uncertainty {:.2g} um. It stands for errors of the machine that "
        "are not in the model and differ from {}; predicted errors of the machine do not include it.",
        common_noise_of(components), 1e3 * components.pose_noise(), 1e3 * components.pose_noise_uncertainty(),
        components.estimated.by_block ? "one block of time to the next" : "pose to pose"));
  }
  if (result.unseen && result.unseen->readings && result.unseen->readings->readings > 0) {
    const ReadingCoverage& found = *result.unseen->readings;
    list.push_back(fmt::format(
        "Of the components of {} held-out readings {:.1f} % lie within two standard uncertainties of the difference "
        "from the prediction (expected: 95 %).",
        found.readings, 100 * static_cast<double>(found.components_within) / static_cast<double>(found.components)));
  }
}

void identification_assumptions(const Study& study, const StudyResult& result, std::vector<std::string>& list) {
  const IdentificationPlan& plan = *study.identification;
  list.emplace_back(
      plan.reversals.empty()
          ? "Every error motion is a function of the position of its own axis only: no temperature, load, speed or "
            "direction of approach; location errors are constants."
          : "Every error motion is a function of the position of its own axis only, the mean of both directions of "
            "approach, apart from the reversal values: no temperature, load or speed; location errors are constants.");
  for (const Setup& setup : study.setups) list.push_back(noise_words(setup));
  if (result.weighed) {
    variance_assumptions(result, list);
  } else {
    list.emplace_back(
        "Residual = (measured - modelled) / standard uncertainty. Uncertainties of the result follow from those of the "
        "readings alone (covariance of the fit); they are not scaled with the residuals.");
  }
  list.emplace_back(
      "Expanded uncertainties and bands are k = 2 standard uncertainties, about 95 % coverage for normal "
      "distributions.");
  if (plan.loss != LossKind::none) {
    list.push_back(
        fmt::format("The {} loss gives gross errors little weight; a reading is called an outlier when its residual is "
                    "larger than one of {:.0f} good readings would have.",
                    loss_name(plan.loss), 1 / IdentifyOptions{}.outlier_norm_quantile));
  }
  if (plan.strategy == Strategy::independent) {
    list.emplace_back(
        "Linear axes are identified first, then rotary axes with the linear ones fixed; their uncertainty "
        "is carried forward.");
  } else if (plan.strategy == Strategy::combined) {
    list.emplace_back(
        "Linear axes are identified first; the result enters the second step as prior knowledge with its "
        "full covariance.");
  }
  if (!result.model.problem.priors.empty()) {
    list.push_back(fmt::format("{} values enter as prior knowledge with their stated standard uncertainty.",
                               result.model.problem.priors.size()));
  }
  if (result.sensors && result.sensors->done) list.push_back(ranked_sensors_sentence(*result.sensors));
  if (result.order_selection && result.order_selection->done) {
    list.emplace_back(
        "Orders are chosen by the residuals at readings left out of the fit; the uncertainties hold for the "
        "chosen orders and do not include that choice.");
  }
  for (const std::string& sentence : coverage_sentences(study, result)) list.push_back(sentence);
  if (!result.identification.gauge.constraints.empty()) {
    list.push_back(
        fmt::format("{} directions that the readings cannot see are fixed by convention (ISO 230); predictions at "
                    "the readings do not depend on them.",
                    result.identification.gauge.constraints.size()));
  }
  if (result.monte_carlo && result.monte_carlo->status == MonteCarloStatus::done) {
    list.push_back(fmt::format(
        "Monte Carlo: {} campaigns with new noise on every used reading, each identified again "
        "jointly with the exact model{}.",
        result.monte_carlo->samples,
        plan.loss == LossKind::none ? "" : "; without the robust loss, which makes the covariance somewhat larger"));
  }
  if (result.campaign.truth) {
    list.emplace_back(
        "Readings are simulated: the true errors are known and shown dashed, in the gauge of the result.");
  }
}

}  // namespace

nlohmann::ordered_json report_identification(const Study& study, const StudyResult& result) {
  const Identification& identified = result.identification;
  nlohmann::ordered_json json;
  json["strategy"] = strategy_name(study.identification->strategy);
  json["loss"] = loss_name(study.identification->loss);
  std::vector<double> singular;
  for (double value : identified.gauge.singular_values) singular.push_back(for_drawing(value));
  json["singular_values"] = singular;
  if (identified.gauge.weak_at_start > 0) json["hardly_seen"] = identified.gauge.weak_at_start;
  json["gauge"] = gauge_json(identified);
  json["history"] = history_json(identified);
  if (result.stages.size() > 1) json["stages"] = stages_json(result);
  if (result.order_selection) json["order_selection"] = orders_json(result);
  return json;
}

std::vector<std::string> report_assumptions(const Study& study, const StudyResult& result) {
  std::vector<std::string> list;
  list.emplace_back(
      "Error = actual - nominal; error motions composed exactly as Rz(EC) Ry(EB) Rx(EA) in axes parallel to the "
      "machine's.");
  if (study.identification) identification_assumptions(study, result, list);
  if (result.map) {
    list.emplace_back(
        "Maps show the deviation of the functional point after the best fit of the workpiece datum (six numbers).");
  }
  if (result.map) {
    for (const std::string& sentence : result.map->moved) list.push_back(sentence);
  }
  for (const std::string& note : result.campaign.notes) list.push_back(note);
  return list;
}

}  // namespace abbe
