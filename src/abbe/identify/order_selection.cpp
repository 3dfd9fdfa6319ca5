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

bool is_nested(const Basis& basis) {
  return basis.kind == BasisKind::monomial || basis.kind == BasisKind::legendre || basis.kind == BasisKind::chebyshev ||
         basis.kind == BasisKind::fourier;
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

class Selection {
 public:
  Selection(const Problem& problem, const std::vector<OrderGroup>& groups, const OrderSelectionOptions& options)
      : problem_(problem),
        groups_(groups),
        options_(options),
        partition_(partition_by_pose(problem, std::max(2, options.folds), options.seed)) {}

  std::vector<std::size_t> parameters(const std::vector<int>& orders) const {
    std::set<std::size_t> dropped;
    std::vector<std::size_t> first;
    std::size_t next = 0;
    for (const ErrorMotion& motion : problem_.errors.motions) {
      first.push_back(next);
      next += motion.coefficients.size();
    }
    for (std::size_t g = 0; g < groups_.size(); ++g)
      for (const std::size_t m : groups_[g].motions) {
        const Basis& basis = problem_.errors.motions[m].basis;
        for (std::size_t k = size_at_order(basis, orders[g]); k < basis.size(); ++k) dropped.insert(first[m] + k);
      }
    std::vector<std::size_t> result;
    for (const std::size_t i : problem_.machine_parameters)
      if (!dropped.count(i)) result.push_back(i);
    return result;
  }

  int highest_order(const OrderGroup& group) const {
    int order = 0;
    for (const std::size_t m : group.motions) order = std::max(order, problem_.errors.motions[m].basis.order);
    return order;
  }

  /// Mean squared residual of every pose when it was held out; empty if a fold could not be identified.
  std::vector<double> held_out_squares(const std::vector<int>& orders, IdentifyStatus& status) const {
    std::vector<double> sums(partition_.fold.size(), 0), counts(partition_.fold.size(), 0);
    const Eigen::VectorXd start = present_values(problem_);
    for (int fold = 0; fold < std::max(2, options_.folds); ++fold) {
      Problem training = problem_, test = problem_;
      training.machine_parameters = test.machine_parameters = parameters(orders);
      drop_higher(orders, training);
      for (std::size_t o = 0; o < problem_.observations.size(); ++o) {
        const std::vector<std::uint8_t>& use = problem_.observations[o].use;
        const std::size_t count = problem_.observations[o].observations->reading_count();
        training.observations[o].use.assign(count, 0);
        test.observations[o].use.assign(count, 0);
        for (std::size_t i = 0; i < count; ++i) {
          if (!use.empty() && !use[i]) continue;
          const bool held_out = partition_.fold[partition_.pose[o][i]] == fold;
          (held_out ? test : training).observations[o].use[i] = 1;
        }
      }
      const Identification identified = identify(training, options_.identify);
      status = identified.status;
      const bool usable = identified.estimates.size() > 0 && status == IdentifyStatus::converged;
      if (usable) {
        test.errors = training.errors;
        const auto norms = ReadingStream(test, options_.identify.solver.threads).norms(identified.estimates);
        for (std::size_t o = 0; o < norms.size(); ++o)
          for (std::size_t i = 0; i < norms[o].size(); ++i) {
            if (norms[o][i] < 0) continue;
            const int rows = problem_.observations[o].observations->rows();
            double square = norms[o][i] * norms[o][i];
            // With a robust loss a gross error counts as an outlier just does: it must not hide what the others say.
            if (options_.identify.loss != LossKind::none) {
              square = std::min(square, chi_square_quantile(options_.identify.outlier_norm_quantile, rows));
            }
            sums[partition_.pose[o][i]] += square;
            counts[partition_.pose[o][i]] += rows;
          }
      }
      set_observations(problem_, start);
      if (!usable) return {};
    }
    std::vector<double> squares;
    for (std::size_t i = 0; i < sums.size(); ++i)
      if (counts[i] > 0) squares.push_back(sums[i] / counts[i]);
    return squares;
  }

 private:
  // Coefficients above the order are no part of the model: zero, not their present value.
  void drop_higher(const std::vector<int>& orders, Problem& problem) const {
    for (std::size_t g = 0; g < groups_.size(); ++g)
      for (const std::size_t m : groups_[g].motions) {
        ErrorMotion& motion = problem.errors.motions[m];
        for (std::size_t k = size_at_order(motion.basis, orders[g]); k < motion.coefficients.size(); ++k)
          motion.coefficients[k] = 0;
      }
  }

  const Problem& problem_;
  const std::vector<OrderGroup>& groups_;
  const OrderSelectionOptions& options_;
  Partition partition_;
};

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

// One-sided paired test that `lower` is lower than `higher` in the mean.
double paired_exceedance(const std::vector<double>& higher, const std::vector<double>& lower) {
  const double n = static_cast<double>(higher.size());
  if (higher.size() != lower.size() || higher.size() < 3) return 1;
  std::vector<double> gains(higher.size());
  for (std::size_t i = 0; i < higher.size(); ++i) gains[i] = higher[i] - lower[i];
  const double average = mean(gains);
  double square = 0;
  for (const double gain : gains) square += (gain - average) * (gain - average);
  const double deviation = std::sqrt(square / (n - 1) / n);
  if (!(deviation > 0)) return average > 0 ? 0 : 1;
  return student_exceedance(average / deviation, n - 1);
}

}  // namespace

std::vector<OrderGroup> order_groups_by_axis(const Machine& machine, const ErrorSet& errors) {
  std::vector<OrderGroup> groups;
  for (std::size_t axis = 0; axis < machine.axes.size(); ++axis) {
    OrderGroup group;
    group.name = machine.axes[axis].name;
    for (std::size_t m = 0; m < errors.motions.size(); ++m)
      if (errors.motions[m].axis == axis && is_nested(errors.motions[m].basis)) group.motions.push_back(m);
    if (!group.motions.empty()) groups.push_back(std::move(group));
  }
  return groups;
}

OrderSelection select_orders(const Problem& problem, const std::vector<OrderGroup>& groups,
                             const OrderSelectionOptions& options) {
  OrderSelection result;
  const Selection selection(problem, groups, options);
  for (const OrderGroup& group : groups)
    result.orders.push_back(std::min(group.start_order, selection.highest_order(group)));
  const auto try_orders = [&](const std::vector<int>& orders, const std::string& raised, std::vector<double>& squares) {
    OrderTrial trial;
    trial.orders = orders;
    trial.raised = raised;
    squares = selection.held_out_squares(orders, trial.status);
    if (!squares.empty()) trial.held_out_rms = std::sqrt(mean(squares));
    result.trials.push_back(std::move(trial));
  };
  std::vector<double> best;
  try_orders(result.orders, "", best);
  if (best.empty()) return result;
  result.trials.back().accepted = true;
  result.done = true;
  for (bool raised = true; raised;) {
    raised = false;
    for (std::size_t g = 0; g < groups.size(); ++g) {
      // Two orders at once as well: an even error may need the fourth and not the third degree.
      for (const int more : {1, 2}) {
        std::vector<int> orders = result.orders;
        orders[g] += more;
        if (orders[g] > selection.highest_order(groups[g])) break;
        std::vector<double> squares;
        try_orders(orders, groups[g].name, squares);
        if (squares.empty()) continue;
        OrderTrial& trial = result.trials.back();
        trial.exceedance = paired_exceedance(best, squares);
        trial.accepted = trial.exceedance < options.significance &&
                         trial.held_out_rms < (1 - options.minimum_gain) * std::sqrt(mean(best));
        if (!trial.accepted) continue;
        best = std::move(squares);
        result.orders = orders;
        raised = true;
        break;
      }
    }
  }
  result.machine_parameters = selection.parameters(result.orders);
  return result;
}

}  // namespace abbe
