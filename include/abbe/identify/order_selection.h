#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "abbe/identify/identify.h"

namespace abbe {

/// Terms of the error model whose orders are raised together: all polynomials of X, or the harmonics of C, or the
/// splines and tables of Z, whose order is their number of intervals.
struct OrderGroup {
  std::string name;                  ///< "X", "C"; "Z intervals" of splines and tables
  std::vector<std::size_t> motions;  ///< indices into ErrorSet::motions
  int start_order = 1;
  int largest_order = 1;
  /// True for polynomials and Fourier series: the lower orders are the first coefficients of the highest. A spline or
  /// table with fewer intervals is another basis.
  bool nested = true;
};

/// Per axis one group of all terms with nested bases, and one of its splines and tables. The largest orders are those
/// of the bases.
std::vector<OrderGroup> order_groups_by_axis(const Machine& machine, const ErrorSet& errors);

/// The problem with the model at these orders, one per group. Its observations stay valid until the next call; all
/// problems have the same readings in the same order.
using ProblemAtOrders = std::function<Problem(const std::vector<int>& orders)>;

/// A problem with the highest orders at lower ones: of nested groups the higher coefficients are zero and no longer
/// estimated. Groups that are not nested stay as they are.
Problem at_nested_orders(Problem problem, const std::vector<OrderGroup>& groups, const std::vector<int>& orders);

struct OrderSelectionOptions {
  int folds = 5;                ///< held-out parts; poses with the same axis positions stay together
  double significance = 0.05;   ///< more intervals are taken if the held-out error falls with this significance,
                                ///< paired over poses
  double minimum_gain = 0.001;  ///< ... and by at least this relative amount
  std::uint64_t seed = 1;       ///< of the partition
  IdentifyOptions identify;
};

/// One model tried.
struct OrderTrial {
  std::vector<int> orders;  ///< per group
  std::string raised;       ///< group whose order was raised against the best so far; empty for the first
  double held_out_rms = 0;  ///< of the residuals at held-out poses, standard uncertainties
  bool accepted = false;
  IdentifyStatus status = IdentifyStatus::not_run;
};

struct OrderSelection {
  bool done = false;                            ///< false: not even the first model could be identified
  std::vector<int> orders;                      ///< chosen, per group
  std::vector<std::size_t> machine_parameters;  ///< of the chosen model, for Problem::machine_parameters
  std::vector<OrderTrial> trials;               ///< in the order tried
};

/// Raises the orders of nested groups as long as the held-out error falls at all; takes more intervals only if it falls
/// significantly (OrderSelectionOptions).
///
/// Nested groups are raised by one and by two; of splines and tables every number of intervals is tried.
OrderSelection select_orders(const ProblemAtOrders& at, const std::vector<OrderGroup>& groups,
                             const OrderSelectionOptions& options = {});

/// The same for nested groups. The problem carries the highest orders allowed; lower orders leave the higher
/// coefficients at zero, so that the observations need not be built again. They stand at their start values afterwards.
OrderSelection select_orders(const Problem& problem, const std::vector<OrderGroup>& groups,
                             const OrderSelectionOptions& options = {});

}  // namespace abbe
