#include "abbe/identify/order_selection.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "abbe/errors/random_stream.h"
#include "abbe/identify/distributions.h"
#include "abbe/identify/normal_equations.h"

namespace abbe {
namespace {

// Mean squared residual, in variances of the readings. Less is rounding: the readings are exact.
constexpr double kNothingLeft = 1e-6;

bool is_nested(const Basis& basis) {
  return basis.kind == BasisKind::monomial || basis.kind == BasisKind::legendre || basis.kind == BasisKind::chebyshev ||
         basis.kind == BasisKind::fourier;
}

// Degree, harmonics, or intervals.
int order_of(const Basis& basis) {
  return basis.nodes.empty() ? basis.order : static_cast<int>(basis.nodes.size()) - (basis.periodic ? 0 : 1);
}

// All numbers of intervals, or steps of about a fifth if there are many.
std::vector<int> interval_counts(const OrderGroup& group) {
  std::vector<int> counts;
  for (int n = group.start_order; n <= group.largest_order; n += std::max(1, n / 5)) counts.push_back(n);
  return counts;
}

std::size_t size_at_order(const Basis& basis, int order) {
  const std::size_t n = static_cast<std::size_t>(std::max(order, 0));
  return std::min(basis.size(), basis.kind == BasisKind::fourier ? 2 * n + 1 : n + 1);
}

/// Poses and their partition; readings with the same axis positions are one pose.
struct Partition {
  std::vector<std::vector<std::size_t>> pose;  // per observations, per reading
  std::vector<int> fold;                       // per pose
};

Partition partition_by_pose(const Problem& problem, int folds, std::uint64_t seed) {
  Partition result;
  std::map<std::vector<std::int64_t>, std::size_t> known;
  for (const SelectedObservations& selected : problem.observations) {
    result.pose.emplace_back();
    for (std::size_t i = 0; i < selected.observations->reading_count(); ++i) {
      std::vector<std::int64_t> key;
      for (const double position : selected.observations->positions(i)) key.push_back(std::llround(position * 1e6));
      result.pose.back().push_back(known.emplace(std::move(key), known.size()).first->second);
    }
  }
  std::vector<std::size_t> order(known.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  RandomStream random(seed);
  for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random.bits() % i]);
  result.fold.resize(order.size());
  for (std::size_t i = 0; i < order.size(); ++i)
    result.fold[order[i]] = static_cast<int>(i % static_cast<std::size_t>(folds));
  return result;
}

// With a robust loss a gross error counts by its size and not by its square: it must not hide what the others say.
// Growing without end all the same, for a model of too low an order makes every reading an outlier. Huber's loss.
double compressed(double square, double limit) {
  return square <= limit ? square : 2 * std::sqrt(limit * square) - limit;
}

// Trials with a convex loss: of a redescending one, residuals that are large everywhere leave no single optimum. What a
// model of too low an order leaves is its noise: by that, not by that of the readings, outliers are told.
IdentifyOptions options_of_trials(IdentifyOptions options) {
  if (options.loss == LossKind::none) return options;
  options.loss = LossKind::huber;
  options.loss_tuning = 0;
  options.scale_from_residuals = true;
  return options;
}

class Selection {
 public:
  Selection(const ProblemAtOrders& at, const OrderSelectionOptions& options)
      : at_(at), options_(options), trials_(options_of_trials(options.identify)) {}

  /// Mean squared residual of every pose when it was held out; empty if a fold could not be identified.
  std::vector<double> held_out_squares(const std::vector<int>& orders, IdentifyStatus& status) {
    const Problem whole = at_(orders);
    if (partition_.fold.empty()) partition_ = partition_by_pose(whole, std::max(2, options_.folds), options_.seed);
    std::vector<double> sums(partition_.fold.size(), 0), counts(partition_.fold.size(), 0);
    const Eigen::VectorXd start = present_values(whole);
    for (int fold = 0; fold < std::max(2, options_.folds); ++fold) {
      const bool usable = hold_out(whole, fold, status, sums, counts);
      set_observations(whole, start);
      if (!usable) return {};
    }
    std::vector<double> squares;
    for (std::size_t i = 0; i < sums.size(); ++i)
      if (counts[i] > 0) squares.push_back(sums[i] / counts[i]);
    return squares;
  }

 private:
  /// Identifies without one part of the poses and adds that part's squares; false if it could not be identified.
  bool hold_out(const Problem& whole, int fold, IdentifyStatus& status, std::vector<double>& sums,
                std::vector<double>& counts) const {
    Problem training = whole, test = whole;
    for (std::size_t o = 0; o < whole.observations.size(); ++o) {
      const std::vector<std::uint8_t>& use = whole.observations[o].use;
      const std::size_t count = whole.observations[o].observations->reading_count();
      training.observations[o].use.assign(count, 0);
      test.observations[o].use.assign(count, 0);
      for (std::size_t i = 0; i < count; ++i) {
        if (!use.empty() && !use[i]) continue;
        const bool held_out = partition_.fold[partition_.pose[o][i]] == fold;
        (held_out ? test : training).observations[o].use[i] = 1;
      }
    }
    const Identification identified = identify(training, trials_);
    status = identified.status;
    if (identified.estimates.size() == 0 || status != IdentifyStatus::converged) return false;
    test.errors = training.errors;
    const auto norms = ReadingStream(test, options_.identify.solver.threads).norms(identified.estimates);
    for (std::size_t o = 0; o < norms.size(); ++o)
      for (std::size_t i = 0; i < norms[o].size(); ++i) {
        if (norms[o][i] < 0) continue;
        const int rows = whole.observations[o].observations->rows();
        double square = norms[o][i] * norms[o][i];
        if (options_.identify.loss != LossKind::none) {
          square = compressed(square, chi_square_quantile(options_.identify.outlier_norm_quantile, rows));
        }
        sums[partition_.pose[o][i]] += square;
        counts[partition_.pose[o][i]] += rows;
      }
    return true;
  }

  const ProblemAtOrders& at_;
  const OrderSelectionOptions& options_;
  IdentifyOptions trials_;
  Partition partition_;
};

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

// One-sided paired test that `lower` is lower than `higher` in the mean.
double paired_exceedance(const std::vector<double>& higher, const std::vector<double>& lower) {
  if (higher.size() != lower.size()) return 1;
  std::vector<double> gains(higher.size());
  for (std::size_t i = 0; i < higher.size(); ++i) gains[i] = higher[i] - lower[i];
  return sum_exceedance(gains, 0);
}

/// The best model so far and the ways to a better one.
class OrderSearch {
 public:
  OrderSearch(const ProblemAtOrders& at, const std::vector<OrderGroup>& groups, const OrderSelectionOptions& options)
      : groups_(groups), options_(options), selection_(at, options) {}

  bool start() {
    for (const OrderGroup& group : groups_) result.orders.push_back(std::min(group.start_order, group.largest_order));
    best_ = tried(result.orders, "");
    // Where the lowest orders cannot be identified, all are raised together: the first model to compare with.
    while (best_.empty() && raise_all()) best_ = tried(result.orders, "all");
    if (best_.empty()) return false;
    result.trials.back().accepted = true;
    result.done = true;
    return true;
  }

  /// Raises a nested group by one; or by two, because an even error may need the fourth and not the third degree.
  /// Taken is what predicts held-out readings better at all: with a test of significance, terms stay out that are
  /// there, and the covariance, which knows nothing of them, is too small.
  bool raise(std::size_t g) {
    if (mean(best_) < kNothingLeft) return false;
    for (const int more : {1, 2}) {
      std::vector<int> orders = result.orders;
      orders[g] += more;
      if (orders[g] > groups_[g].largest_order) return false;
      std::vector<double> squares = tried(orders, groups_[g].name);
      if (squares.empty()) continue;
      if (!(mean(squares) < mean(best_))) continue;
      accept(result.trials.size() - 1, std::move(squares));
      return true;
    }
    return false;
  }

  /// Tries every number of intervals: knots elsewhere may be better or worse, so that no few steps show the way. Taken
  /// is the smallest number than which the best one is not significantly better.
  bool choose_intervals(std::size_t g) {
    std::vector<std::vector<double>> squares;
    std::vector<std::size_t> trial;
    std::size_t least = 0;
    for (const int count : interval_counts(groups_[g])) {
      if (count == result.orders[g]) continue;
      std::vector<int> orders = result.orders;
      orders[g] = count;
      std::vector<double> one = tried(orders, groups_[g].name);
      if (one.empty()) continue;
      trial.push_back(result.trials.size() - 1);
      squares.push_back(std::move(one));
      if (mean(squares.back()) < mean(squares[least])) least = squares.size() - 1;
    }
    if (squares.empty() || !is_better(best_, squares[least])) return false;
    for (std::size_t i = 0; i < squares.size(); ++i) {
      if (is_better(squares[i], squares[least])) continue;
      accept(trial[i], std::move(squares[i]));
      return true;
    }
    return false;
  }

  OrderSelection result;

 private:
  bool raise_all() {
    bool raised = false;
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      if (result.orders[g] >= groups_[g].largest_order) continue;
      ++result.orders[g];
      raised = true;
    }
    return raised;
  }

  std::vector<double> tried(const std::vector<int>& orders, const std::string& raised) {
    OrderTrial trial;
    trial.orders = orders;
    trial.raised = raised;
    std::vector<double> squares = selection_.held_out_squares(orders, trial.status);
    if (!squares.empty()) trial.held_out_rms = std::sqrt(mean(squares));
    result.trials.push_back(std::move(trial));
    return squares;
  }

  bool is_better(const std::vector<double>& than, const std::vector<double>& squares) const {
    return mean(than) >= kNothingLeft && paired_exceedance(than, squares) < options_.significance &&
           std::sqrt(mean(squares)) < (1 - options_.minimum_gain) * std::sqrt(mean(than));
  }

  void accept(std::size_t trial, std::vector<double> squares) {
    result.trials[trial].accepted = true;
    result.orders = result.trials[trial].orders;
    best_ = std::move(squares);
  }

  const std::vector<OrderGroup>& groups_;
  const OrderSelectionOptions& options_;
  Selection selection_;
  std::vector<double> best_;
};

}  // namespace

std::vector<OrderGroup> order_groups_by_axis(const Machine& machine, const ErrorSet& errors) {
  std::vector<OrderGroup> groups;
  for (std::size_t axis = 0; axis < machine.axes.size(); ++axis)
    for (const bool nested : {true, false}) {
      OrderGroup group;
      group.name = machine.axes[axis].name + (nested ? "" : " intervals");
      group.nested = nested;
      group.largest_order = 0;
      for (std::size_t m = 0; m < errors.motions.size(); ++m) {
        if (errors.motions[m].state != kNoState) continue;
        if (errors.motions[m].axis != axis || is_nested(errors.motions[m].basis) != nested) continue;
        group.motions.push_back(m);
        group.largest_order = std::max(group.largest_order, order_of(errors.motions[m].basis));
      }
      if (!group.motions.empty()) groups.push_back(std::move(group));
    }
  return groups;
}

Problem at_nested_orders(Problem problem, const std::vector<OrderGroup>& groups, const std::vector<int>& orders) {
  std::set<std::size_t> dropped;
  std::vector<std::size_t> first;
  std::size_t next = 0;
  for (const ErrorMotion& motion : problem.errors.motions) {
    first.push_back(next);
    next += motion.coefficients.size();
  }
  for (std::size_t g = 0; g < groups.size(); ++g) {
    if (!groups[g].nested) continue;
    for (const std::size_t m : groups[g].motions) {
      ErrorMotion& motion = problem.errors.motions[m];
      // Coefficients above the order are no part of the model: zero, not their present value.
      for (std::size_t k = size_at_order(motion.basis, orders[g]); k < motion.coefficients.size(); ++k) {
        motion.coefficients[k] = 0;
        dropped.insert(first[m] + k);
      }
    }
  }
  std::vector<std::size_t> kept;
  for (const std::size_t i : problem.machine_parameters)
    if (!dropped.count(i)) kept.push_back(i);
  problem.machine_parameters = std::move(kept);
  return problem;
}

OrderSelection select_orders(const ProblemAtOrders& at, const std::vector<OrderGroup>& groups,
                             const OrderSelectionOptions& options) {
  OrderSearch search(at, groups, options);
  if (!search.start()) return search.result;
  // A group is done until another one has changed.
  std::vector<std::uint8_t> open(groups.size(), 1);
  while (std::find(open.begin(), open.end(), 1) != open.end()) {
    for (std::size_t g = 0; g < groups.size(); ++g) {
      if (open[g] == 0) continue;
      open[g] = 0;
      if (!(groups[g].nested ? search.raise(g) : search.choose_intervals(g))) continue;
      std::fill(open.begin(), open.end(), std::uint8_t{1});
      if (!groups[g].nested) open[g] = 0;
    }
  }
  search.result.machine_parameters = at(search.result.orders).machine_parameters;
  return search.result;
}

OrderSelection select_orders(const Problem& problem, const std::vector<OrderGroup>& groups,
                             const OrderSelectionOptions& options) {
  const Eigen::VectorXd start = present_values(problem);
  OrderSelection result = select_orders(
      [&](const std::vector<int>& orders) { return at_nested_orders(problem, groups, orders); }, groups, options);
  set_observations(problem, start);
  return result;
}

}  // namespace abbe
