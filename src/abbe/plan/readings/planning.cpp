#include "abbe/plan/readings/planning.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <tuple>

#include "abbe/errors/random_stream.h"
#include "abbe/plan/readings/planning_design.h"

namespace abbe {
namespace {

constexpr std::size_t kUpdatesBetweenFactorisations = 128;
// Of the information that an average choice of this size has; keeps the greedy start going before everything is seen.
constexpr double kRidge = 1e-3;

class PlanSearch {
 public:
  PlanSearch(const PlanningSpace& space, const PlanningOptions& options)
      : space_(space),
        options_(options),
        by_variance_(options.criterion == PlanningCriterion::variance),
        design_(space, by_variance_ ? space.functionals(options.functionals) : Eigen::MatrixXd(), options.threads,
                options.in_step, options.in_step.processes > 1 ? fingerprint_of_choosing(space, options) : 0) {
    rules_.eligible = &options_.eligible;
    if (!options_.group.empty()) rules_.group = &options_.group;
    rules_.repeats = options_.repeats;
    rules_.per_cost = space.has_costs() && std::isfinite(options.time_s);
  }

  ReadingPlan run() {
    ReadingPlan best;
    for (int start = 0; start < std::max(1, options_.starts); ++start) {
      start_ = start;
      ReadingPlan plan;
      if (!(start == 0 ? first_start() : random_start(static_cast<std::uint64_t>(start)))) {
        if (best.status == PlanningStatus::not_run)
          best.status = nothing_chosen_ ? PlanningStatus::nothing_fits : PlanningStatus::not_determined;
        continue;
      }
      improve(plan);
      if (plan.status != PlanningStatus::done) {
        if (best.status == PlanningStatus::not_run) best.status = plan.status;
        continue;
      }
      if (best.status != PlanningStatus::done || plan.history.back() < best.history.back() - design_.tie())
        best = std::move(plan);
    }
    return best;
  }

  /// Adds until `count`; false if no candidate is left.
  bool grow(std::size_t count) {
    while (design_.chosen().size() < count) {
      close_groups(rules_);
      const ScoredCandidate best = design_.best_to_add(rules_);
      if (best.candidate == static_cast<std::size_t>(-1)) return false;
      design_.add(best.candidate);
      if (!refresh()) return false;
    }
    return true;
  }
  /// False if the choice determines everything so weakly that nothing can be added to it one by one.
  bool start_from(const std::vector<std::size_t>& chosen) { return design_.rebuild(chosen, 0); }

  ReadingPlan chosen() const {
    ReadingPlan plan;
    plan.chosen = design_.chosen();
    std::sort(plan.chosen.begin(), plan.chosen.end());
    plan.history = {design_.objective()};
    return plan;
  }

  void find_value(ReadingPlan& plan) const {
    plan.value = value_of(space_, plan.chosen, by_variance_ ? options_.functionals : Eigen::MatrixXd());
    // The design takes a choice for determined that its rows, factorised, are not.
    plan.status = plan.value.determined ? PlanningStatus::done : PlanningStatus::not_determined;
  }

  /// Each process finds those of some plans.
  void find_values(std::span<ReadingPlan> plans) const {
    constexpr std::size_t kNumbers = 5;
    std::vector<double> found(plans.size() * kNumbers);
    std::vector<PlanShares::Piece> pieces;
    const PlanShares shares = design_.shares().of(plans.size());
    for (std::size_t k = 0; k < plans.size(); ++k) {
      const std::span<double> numbers(&found[k * kNumbers], kNumbers);
      pieces.push_back({shares.owner(k), numbers});
      if (shares.owner(k) != shares.rank()) continue;
      find_value(plans[k]);
      const PlanValue& value = plans[k].value;
      const double given[kNumbers] = {static_cast<double>(value.rank), value.determined ? 1.0 : 0.0,
                                      value.log_determinant, value.variance, value.cost};
      std::copy_n(given, kNumbers, numbers.begin());
    }
    shares.complete(pieces);
    for (std::size_t k = 0; k < plans.size(); ++k) {
      const double* const n = &found[k * kNumbers];
      plans[k].value = {static_cast<std::size_t>(n[0]), n[1] != 0, n[2], n[3], n[4]};
      plans[k].status = plans[k].value.determined ? PlanningStatus::done : PlanningStatus::not_determined;
    }
  }

 private:
  std::size_t count_limit() const {
    return options_.count > 0 ? options_.count : std::numeric_limits<std::size_t>::max();
  }
  double time_left() const { return options_.time_s - design_.cost(); }

  /// Marks the groups that are full, once the reading at a place is gone.
  void close_groups(PlanDesign::Allowed& rules, std::size_t without = static_cast<std::size_t>(-1)) const {
    if (rules.group == nullptr) return;
    std::vector<std::size_t> left = options_.most_of_group;
    for (std::size_t place = 0; place < design_.chosen().size(); ++place) {
      std::size_t& own = left[options_.group[design_.chosen()[place]]];
      if (place != without && own > 0) --own;
    }
    rules.full.assign(left.size(), 0);
    for (std::size_t g = 0; g < left.size(); ++g) rules.full[g] = left[g] == 0 ? 1 : 0;
  }

  bool refresh() {
    return design_.updates() < kUpdatesBetweenFactorisations || design_.rebuild(design_.chosen(), ridge_);
  }

  // Typical information of a choice in coordinates where all candidates have the unit matrix.
  double typical_ridge() const {
    const double share = static_cast<double>(options_.count > 0 ? options_.count : space_.dimension()) /
                         static_cast<double>(space_.count());
    return kRidge * std::min(1.0, share);
  }

  bool fill() {
    PlanDesign::Allowed rules = rules_;
    while (design_.chosen().size() < count_limit()) {
      rules.most_cost = time_left();
      close_groups(rules);
      const ScoredCandidate best = design_.best_to_add(rules);
      if (best.candidate == static_cast<std::size_t>(-1)) break;
      design_.add(best.candidate);
      if (!refresh()) return false;
    }
    return true;
  }

  bool first_start() {
    if (options_.start.empty() || !design_.rebuild(options_.start, 0)) return greedy_start();
    ridge_ = 0;
    return fill();
  }

  bool greedy_start() {
    ridge_ = typical_ridge();
    if (!design_.rebuild({}, ridge_) || !fill()) return false;
    if (finish_start()) return true;
    if (!by_variance_ || nothing_chosen_) return false;
    // Functionals may leave directions open that they do not depend on.
    PlanningOptions all = options_;
    all.criterion = PlanningCriterion::determinant;
    all.starts = 1;
    all.most_passes = 0;
    all.start.clear();
    all.progress = nullptr;
    const ReadingPlan plan = plan_readings(space_, all);
    return plan.status == PlanningStatus::done && design_.rebuild(plan.chosen, 0);
  }

  bool random_start(std::uint64_t number) {
    // A random half, completed greedily: wholly random ones often do not determine everything.
    RandomStream random(options_.seed, number);
    std::vector<std::size_t> order, chosen;
    for (std::size_t i = 0; i < space_.count(); ++i)
      if (options_.eligible.empty() || options_.eligible[i] != 0) order.push_back(i);
    double time = 0;
    std::vector<std::size_t> room = options_.most_of_group;
    const std::size_t wanted = std::min(count_limit(), order.size());
    for (std::size_t k = 0; k < order.size() && chosen.size() < (wanted + 1) / 2 && time < options_.time_s / 2; ++k) {
      const std::size_t left = order.size() - k;
      std::swap(order[k],
                order[k + std::min(left - 1, static_cast<std::size_t>(random.uniform() * static_cast<double>(left)))]);
      if (time + space_.cost(order[k]) > options_.time_s) continue;
      if (!room.empty() && room[options_.group[order[k]]]-- == 0) {
        room[options_.group[order[k]]] = 0;
        continue;
      }
      chosen.push_back(order[k]);
      time += space_.cost(order[k]);
    }
    ridge_ = typical_ridge();
    if (!design_.rebuild(chosen, ridge_) || !fill()) return false;
    return finish_start();
  }

  bool finish_start() {
    ridge_ = 0;
    nothing_chosen_ = design_.chosen().empty();
    return !nothing_chosen_ && design_.rebuild(design_.chosen(), 0);
  }

  double change_of(double gain) const { return -gain * (by_variance_ ? std::abs(design_.objective()) : 1.0); }

  void improve(ReadingPlan& plan) {
    plan.history = {design_.objective()};
    std::vector<std::size_t> order;
    for (int pass = 0; pass < options_.most_passes; ++pass) {
      const std::size_t exchanges_before = plan.exchanges;
      const double objective_before = design_.objective();
      order_by_loss(order);
      std::size_t together = 1, known_from = 0;
      std::vector<ScoredCandidate> known;  // best exchange for each place of the order, from known_from on
      for (std::size_t k = 0; k < order.size(); ++k) {
        if (k >= known_from + known.size()) {
          known_from = k;
          known = best_instead(std::span(order).subspan(k, std::min(together, order.size() - k)));
        }
        if (exchange_one(order[k], known[k - known_from], plan)) {
          together = 1;
          known.clear();
        } else {
          // Places looked at together are looked at in vain once one of them is exchanged. The more places in a row
          // bring nothing, the less likely that is.
          together = std::min(2 * together, PlanDesign::kMostPlaces);
        }
        if (options_.progress)
          options_.progress((start_ + (pass + static_cast<double>(k + 1) / static_cast<double>(order.size())) /
                                          options_.most_passes) /
                            std::max(1, options_.starts));
      }
      ++plan.passes;
      const std::size_t before = design_.chosen().size();
      if (!fill()) break;
      if (design_.chosen().size() > before) continue;
      const double change = design_.objective() - objective_before;
      if (plan.exchanges == exchanges_before ||
          change > change_of(options_.pass_gain * (by_variance_ ? 1.0 : static_cast<double>(space_.dimension()))))
        break;
    }
    const std::vector<double> history = plan.history;
    const std::size_t exchanges = plan.exchanges, passes = plan.passes;
    plan = chosen();
    find_value(plan);
    plan.history.insert(plan.history.begin(), history.begin(), history.end());
    plan.exchanges = exchanges;
    plan.passes = passes;
  }

  /// The places of the choice, those first that are missed least; equal ones in the order of their candidates.
  void order_by_loss(std::vector<std::size_t>& order) const {
    const std::vector<std::size_t>& chosen = design_.chosen();
    order.resize(chosen.size());
    const std::vector<double> losses = design_.losses();
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return losses[a] < losses[b]; });
    const auto by_candidate = [&](std::size_t a, std::size_t b) {
      return std::tie(chosen[a], a) < std::tie(chosen[b], b);
    };
    for (auto first = order.begin(); first != order.end();) {
      auto last = std::next(first);
      while (last != order.end() && !(losses[*last] > losses[*std::prev(last)] + design_.tie())) ++last;
      std::sort(first, last, by_candidate);
      first = last;
    }
  }

  std::vector<ScoredCandidate> best_instead(std::span<const std::size_t> places) {
    std::vector<PlanDesign::Allowed> rules(places.size(), rules_);
    for (std::size_t k = 0; k < places.size(); ++k) {
      rules[k].per_cost = false;
      rules[k].most_cost = time_left() + space_.cost(design_.chosen()[places[k]]);
      rules[k].ceiling = change_of(options_.smallest_gain);
      close_groups(rules[k], places[k]);
    }
    return design_.best_instead(places, rules);
  }

  bool exchange_one(std::size_t place, const ScoredCandidate& best, ReadingPlan& plan) {
    if (!(best.change < change_of(options_.smallest_gain)) || !design_.exchange(place, best.candidate)) return false;
    ++plan.exchanges;
    plan.history.push_back(design_.objective());
    refresh();
    return true;
  }

  const PlanningSpace& space_;
  const PlanningOptions& options_;
  bool by_variance_;
  PlanDesign design_;
  PlanDesign::Allowed rules_;
  double ridge_ = 0;
  int start_ = 0;
  bool nothing_chosen_ = false;
};

void check(const PlanningSpace& space, const PlanningOptions& options) {
  if (options.count == 0 && !std::isfinite(options.time_s))
    throw std::invalid_argument("planning: neither a number of readings nor a time is given");
  if (!options.eligible.empty() && options.eligible.size() != space.count())
    throw std::invalid_argument("planning: eligible is not one per candidate");
  if (!options.group.empty() && options.group.size() != space.count())
    throw std::invalid_argument("planning: group is not one per candidate");
  for (const std::uint32_t group : options.group)
    if (group >= options.most_of_group.size()) throw std::invalid_argument("planning: a group without a number");
  for (const std::size_t i : options.start)
    if (i >= space.count()) throw std::invalid_argument("planning: the start is not among the candidates");
  if (options.repeats == 0) throw std::invalid_argument("planning: every reading would be refused");
  if (options.criterion == PlanningCriterion::variance &&
      (options.functionals.rows() == 0 ||
       static_cast<std::size_t>(options.functionals.cols()) != space.parameter_count()))
    throw std::invalid_argument("planning: the functionals are missing or have another length than the estimates");
}

}  // namespace

const char* status_text(PlanningStatus status) {
  switch (status) {
    case PlanningStatus::not_run:
      return "not run";
    case PlanningStatus::done:
      return "done";
    case PlanningStatus::not_determined:
      return "too few readings to determine what the candidates can see";
    case PlanningStatus::nothing_fits:
      break;
  }
  return "no candidate is allowed";
}

ReadingPlan plan_readings(const PlanningSpace& space, const PlanningOptions& options) {
  check(space, options);
  return PlanSearch(space, options).run();
}

std::vector<ReadingPlan> plan_curve(const PlanningSpace& space, const PlanningOptions& options,
                                    std::span<const std::size_t> counts) {
  std::vector<ReadingPlan> curve;
  PlanningOptions grown = options;
  grown.time_s = std::numeric_limits<double>::infinity();
  std::size_t next = 0;
  PlanSearch search(space, grown);
  // Too small a number may determine nothing yet, or too little to go on from.
  for (; next < counts.size(); ++next) {
    grown.count = counts[next];
    curve.push_back(plan_readings(space, grown));
    if (curve.back().status == PlanningStatus::done && search.start_from(curve.back().chosen)) break;
  }
  if (next >= counts.size()) return curve;
  const std::size_t grown_from = curve.size();
  for (++next; next < counts.size(); ++next) {
    if (!search.grow(counts[next])) break;
    curve.push_back(search.chosen());
  }
  search.find_values(std::span(curve).subspan(grown_from));
  return curve;
}

std::size_t enough_points(std::span<const std::size_t> counts, std::span<const double> uncertainty, double spare) {
  std::size_t enough = counts.size();
  for (std::size_t k = std::min(counts.size(), uncertainty.size()); k-- > 1;) {
    const double slope = std::log(uncertainty[k - 1] / uncertainty[k]) /
                         std::log(static_cast<double>(counts[k]) / static_cast<double>(counts[k - 1]));
    if (!(slope <= 0.5 + spare)) break;
    enough = k - 1;
  }
  return enough;
}

}  // namespace abbe
