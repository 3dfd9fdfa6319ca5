#include "abbe/study/identification/identified_expansions.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "abbe/errors/expansion.h"
#include "abbe/errors/random_stream.h"
#include "abbe/geometry/decompositions.h"

namespace abbe {
namespace {

// A stream of its own, apart from those of the other true errors.
constexpr std::uint64_t kExpansionStream = 1'000'000'033, kThermometerStream = 1'000'100'033;

const IdentificationPlan& plan_in_use(const Study& study, const StudyResult& result) {
  return result.terms ? result.terms->plan : *study.identification;
}

/// Parameter with which an estimate is correlated most.
void note_correlation(const Identification& identified, Eigen::Index at, FoundExpansion& found) {
  for (Eigen::Index k = 0; k < identified.covariance.rows(); ++k) {
    const double product = identified.covariance(at, at) * identified.covariance(k, k);
    if (k == at || !(product > 0)) continue;
    const double correlation = identified.covariance(at, k) / std::sqrt(product);
    if (!(std::abs(correlation) > std::abs(found.correlation))) continue;
    found.correlation = correlation;
    found.correlated = identified.parameters[static_cast<std::size_t>(k)].name;
  }
}

/// What is known of the temperatures of one thermometer: errors of their own, and one that they share.
JointPrior common_prior(const std::vector<ExpansionParameters>& members) {
  const auto count = static_cast<Eigen::Index>(members.size());
  Eigen::VectorXd effect(count), uncertainty(count);
  JointPrior prior;
  for (Eigen::Index i = 0; i < count; ++i) {
    const ExpansionParameters& one = members[static_cast<std::size_t>(i)];
    prior.parameters.push_back({ParameterId::kMachine, one.coefficient});
    effect[i] = one.identified->expansion->thermometer_effect;
    uncertainty[i] = one.identified->expansion->coefficient.standard_uncertainty;
  }
  Eigen::MatrixXd covariance = effect * effect.transpose();
  covariance.diagonal() = uncertainty.cwiseAbs2();
  prior.value = Eigen::VectorXd::Zero(count);
  prior.information = Ldlt<>(covariance).solve_columns(Eigen::MatrixXd::Identity(count, count));
  prior.residual_count = static_cast<double>(count);
  return prior;
}

/// Numbers of the truth of a study's expansions.
class TrueExpansions {
 public:
  explicit TrueExpansions(std::uint64_t seed) : seed_(seed) {}

  double draw(const IdentifiedExpansion& expansion) {
    const SetupNumber& known = expansion.coefficient;
    RandomStream random(seed_, stream_++);
    if (known.knowledge != Knowledge::within) return known.value;
    if (expansion.thermometer.empty()) return known.value + known.standard_uncertainty * random.normal();
    const double effect = expansion.thermometer_effect, all = known.standard_uncertainty;
    const double own = std::sqrt(std::max(0.0, all * all - effect * effect));
    return known.value + own * random.normal() + effect * error_of(expansion.thermometer);
  }

 private:
  /// In standard uncertainties; the same for all scales of the thermometer.
  double error_of(const std::string& thermometer) {
    const auto found = errors_.find(thermometer);
    if (found != errors_.end()) return found->second;
    RandomStream random(seed_, kThermometerStream + errors_.size());
    return errors_.emplace(thermometer, random.normal()).first->second;
  }

  std::uint64_t seed_, stream_ = kExpansionStream;
  std::map<std::string, double> errors_;
};

}  // namespace

std::vector<ExpansionParameters> expansion_parameters(const IdentificationPlan& plan, const ErrorSet& errors) {
  std::vector<ExpansionParameters> result;
  for (const IdentifiedMotion& one : plan.motions) {
    if (!one.expansion) continue;
    std::size_t next = 0;
    for (std::size_t m = 0; m < errors.motions.size(); ++m) {
      const ErrorMotion& motion = errors.motions[m];
      const bool same = motion.axis == one.axis && motion.component == one.component && motion.state == one.state &&
                        motion.basis == one.basis;
      if (same) result.push_back({&one, m, next + 1});
      next += motion.coefficients.size();
    }
  }
  return result;
}

std::vector<std::uint8_t> are_of_expansions(const IdentificationPlan& plan, const ErrorSet& errors) {
  std::vector<std::uint8_t> result(errors.parameter_count(), 0);
  for (const ExpansionParameters& one : expansion_parameters(plan, errors)) {
    result[one.coefficient] = result[one.coefficient - 1] = 1;
  }
  return result;
}

void keep_expansion_estimates(const IdentificationPlan& plan, Problem& problem) {
  for (const ExpansionParameters& one : expansion_parameters(plan, problem.errors)) {
    const bool exact = one.identified->expansion->coefficient.knowledge == Knowledge::exact;
    std::erase_if(problem.machine_parameters, [&](std::size_t parameter) {
      return parameter == one.coefficient - 1 || (exact && parameter == one.coefficient);
    });
  }
}

void add_expansion_priors(const IdentificationPlan& plan, Problem& problem) {
  std::vector<ExpansionParameters> with_thermometer;
  for (const ExpansionParameters& one : expansion_parameters(plan, problem.errors)) {
    const SetupNumber& known = one.identified->expansion->coefficient;
    if (known.knowledge != Knowledge::within) continue;
    if (!one.identified->expansion->thermometer.empty()) {
      with_thermometer.push_back(one);
      continue;
    }
    problem.priors.push_back({{ParameterId::kMachine, one.coefficient}, known.value, known.standard_uncertainty});
  }
  while (!with_thermometer.empty()) {
    const std::string name = with_thermometer.front().identified->expansion->thermometer;
    const auto others = std::stable_partition(
        with_thermometer.begin(), with_thermometer.end(),
        [&](const ExpansionParameters& one) { return one.identified->expansion->thermometer == name; });
    problem.joint_priors.push_back(common_prior({with_thermometer.begin(), others}));
    with_thermometer.erase(with_thermometer.begin(), others);
  }
}

bool has_known_expansions_only(const IdentificationPlan& plan, std::size_t state) {
  bool any = false;
  for (const IdentifiedMotion& one : plan.motions) {
    if (one.state != state) continue;
    if (!one.expansion || one.expansion->coefficient.knowledge == Knowledge::open) return false;
    any = true;
  }
  return any && std::none_of(plan.locations.begin(), plan.locations.end(),
                             [&](const IdentifiedLocation& one) { return one.state == state; });
}

void add_true_expansions(const Study& study, std::uint64_t seed, ErrorSet& errors) {
  if (!study.identification) return;
  TrueExpansions drawn(seed);
  for (const IdentifiedMotion& one : study.identification->motions) {
    if (!one.expansion) continue;
    const double value = drawn.draw(*one.expansion);
    errors.motions.push_back(
        {one.axis, one.component, one.basis, {0, one.expansion->coefficient.truth.value_or(value)}, {}, one.state});
  }
}

std::vector<FoundExpansion> found_expansions(const Study& study, const StudyResult& result) {
  std::vector<FoundExpansion> list;
  const Identification& identified = result.identification;
  const Machine& machine = study.machine;
  for (const ExpansionParameters& one : expansion_parameters(plan_in_use(study, result), identified.errors)) {
    if (one.identified->expansion->is_temperature) continue;
    const ErrorMotion& term = identified.errors.motions[one.motion];
    const double scale = expansion_scale(machine, term);
    FoundExpansion found;
    found.axis = machine.axes[term.axis].name;
    found.state = machine.states[term.state].name;
    found.coefficient = term.coefficients[1] / scale;
    found.fixed_point = 0.5 * (term.basis.from + term.basis.to);
    found.stated = one.identified->expansion->coefficient;
    found.stated.value /= scale;
    found.stated.standard_uncertainty /= std::abs(scale);
    for (std::size_t i = 0; i < identified.parameters.size(); ++i) {
      if (identified.parameters[i].id != ParameterId{ParameterId::kMachine, one.coefficient}) continue;
      const auto at = static_cast<Eigen::Index>(i);
      found.expanded_uncertainty = 2 * std::sqrt(std::max(0.0, identified.covariance(at, at))) / std::abs(scale);
      found.is_fixed = !(found.expanded_uncertainty > 0);
      note_correlation(identified, at, found);
    }
    list.push_back(std::move(found));
  }
  return list;
}

}  // namespace abbe
