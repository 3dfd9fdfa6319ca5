#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "abbe/identify/identify.h"

namespace abbe {

/// Terms of the error model whose orders are raised together: all motions of X, or the harmonics of C.
struct OrderGroup {
  std::string name;                  ///< "X", "C"
  std::vector<std::size_t> motions;  ///< indices into ErrorSet::motions; nested bases (polynomials, Fourier) only
  int start_order = 1;
};

/// One group per axis, of all terms with nested bases of that axis.
std::vector<OrderGroup> order_groups_by_axis(const Machine& machine, const ErrorSet& errors);

struct OrderSelectionOptions {
  int folds = 5;                ///< held-out parts; poses with the same axis positions stay together
  double significance = 0.05;   ///< a higher order stays if the held-out error falls with this significance
  double minimum_gain = 0.001;  ///< ... and by at least this relative amount
  std::uint64_t seed = 1;       ///< of the partition
  IdentifyOptions identify;
};

/// One model tried.
struct OrderTrial {
  std::vector<int> orders;  ///< per group
  std::string raised;       ///< group whose order was raised against the best so far; empty for the first
  double held_out_rms = 0;  ///< of the residuals at held-out poses, standard uncertainties
  double exceedance = 1;    ///< one-sided, paired over poses: probability of such a gain by chance
  bool accepted = false;
  IdentifyStatus status = IdentifyStatus::not_run;
};

struct OrderSelection {
  bool done = false;                            ///< false: not even the first model could be identified
  std::vector<int> orders;                      ///< chosen, per group
  std::vector<std::size_t> machine_parameters;  ///< of the chosen model, for Problem::machine_parameters
  std::vector<OrderTrial> trials;               ///< in the order tried
};

/// Raises the orders group by group as long as the error at held-out poses falls significantly.
///
/// The problem carries the highest orders allowed; lower orders leave the higher coefficients at zero, so that the
/// observations need not be built again.
OrderSelection select_orders(const Problem& problem, const std::vector<OrderGroup>& groups,
                             const OrderSelectionOptions& options = {});

}  // namespace abbe
