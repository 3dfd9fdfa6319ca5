#include "abbe/study/identified_expansions.h"

#include <algorithm>
#include <cmath>

#include "abbe/errors/expansion.h"
#include "abbe/errors/random_stream.h"

namespace abbe {
namespace {

// A stream of its own, apart from those of the other true errors.
constexpr std::uint64_t kExpansionStream = 1'000'000'033;

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
  for (const ExpansionParameters& one : expansion_parameters(plan, problem.errors)) {
    const SetupNumber& known = one.identified->expansion->coefficient;
    if (known.knowledge != Knowledge::within) continue;
    problem.priors.push_back({{ParameterId::kMachine, one.coefficient}, known.value, known.standard_uncertainty});
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
  std::uint64_t stream = kExpansionStream;
  for (const IdentifiedMotion& one : study.identification->motions) {
    if (!one.expansion) continue;
    const SetupNumber& known = one.expansion->coefficient;
    RandomStream random(seed, stream++);
    const double drawn =
        known.knowledge == Knowledge::within ? known.value + known.standard_uncertainty * random.normal() : known.value;
    errors.motions.push_back({one.axis, one.component, one.basis, {0, known.truth.value_or(drawn)}, {}, one.state});
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
