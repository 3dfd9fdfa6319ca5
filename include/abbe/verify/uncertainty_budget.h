#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace abbe {

/// One source of uncertainty of a result: an input that is not known exactly.
struct BudgetInput {
  std::string cause;                ///< inputs of one cause are one line of the budget
  double standard_uncertainty = 0;  ///< in the input's own unit
};

/// The result for deviations of all inputs: [kinds, points], such as across and along a curve at its points.
using BudgetModel = std::function<Eigen::MatrixXd(const std::vector<double>& deviations)>;

struct BudgetOptions {
  std::size_t runs = 2000;           ///< of all inputs together
  std::size_t runs_per_cause = 300;  ///< of the inputs of one cause
  std::uint64_t seed = 1;
};

/// Contribution of one source, or of all, to one kind of result.
struct BudgetFigure {
  double by_sensitivity = 0;  ///< standard uncertainty, root mean square over the points
  double by_monte_carlo = 0;
  double monte_carlo_uncertainty = 0;  ///< standard, of by_monte_carlo: it has been drawn so often only

  /// Difference of both in units of Monte Carlo's own uncertainty.
  double disagreement() const;
};

/// One line of a budget.
struct BudgetLine {
  std::string cause;
  std::size_t inputs = 0;
  std::vector<BudgetFigure> kinds;
  double share = 0;  ///< of the variance of all kinds together, by sensitivity; 0 .. 1
};

/// An uncertainty budget, twice: linearly by sensitivity, and by drawing.
struct UncertaintyBudget {
  std::vector<BudgetLine> lines;    ///< largest share first
  std::vector<BudgetFigure> total;  ///< per kind
  std::size_t inputs = 0, runs = 0, runs_per_cause = 0;

  /// Largest disagreement of any figure that is more than this part of its kind's total, either way.
  double largest_disagreement(double negligible = 0.01) const;
};

/// Law of propagation of uncertainty (JCGM 100: sensitivities by central differences of one standard uncertainty) and
/// propagation of distributions (JCGM 101: normal, independent inputs) side by side. They agree within Monte Carlo's
/// own uncertainty as long as the model is straight over the uncertainties of its inputs.
/// @param each_run  called with the result of every run of all inputs together, or empty
/// @throws std::invalid_argument if the model's results have different shapes
UncertaintyBudget uncertainty_budget(const BudgetModel& model, const std::vector<BudgetInput>& inputs,
                                     const BudgetOptions& options = {},
                                     const std::function<void(const Eigen::MatrixXd&)>& each_run = {});

}  // namespace abbe
