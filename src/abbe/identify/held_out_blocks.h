#pragma once

// Models of terms judged by blocks of readings that are held out: sums of every block at one point, and what follows
// from them for any choice of parameters.
#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "abbe/identify/identify.h"
#include "abbe/identify/normal_equations.h"
#include "abbe/identify/time_blocks.h"

namespace abbe {

/// Wald's test of further parameters in the fit to all readings.
struct TermTest {
  double wald = 0;        ///< chi-square of what is added, by the uncertainties as stated
  double dispersion = 1;  ///< how much more its estimates scatter from block to block than those say
};

/// The model is linear in what its terms add: readings of all blocks give their normal equations once, and every choice
/// of parameters is solved from these. Parameters that are not present are zero.
class HeldOutBlocks {
 public:
  using Columns = std::vector<Eigen::Index>;  ///< of the estimates

  /// Sums every block at the point where the problem and its observations stand.
  /// @param problem  with all parameters
  HeldOutBlocks(const Problem& problem, const std::vector<TimeBlocks>& blocks, const IdentifyOptions& options);

  /// The parameters of the model from now on; predicts every block anew.
  void set_present(Columns present);
  const Columns& present() const { return present_; }

  /// Of the blocks that can be predicted.
  double mean_square() const;
  std::size_t predicted() const;  ///< how many these are
  std::size_t count() const { return sums_.size(); }

  /// Mean squared residual of every block, in variances of the readings; NaN: not predicted.
  std::vector<double> squares() const;
  /// The estimates without a block; parameters that are not present as they were at the start.
  Eigen::VectorXd estimates_without(std::size_t block) const;
  /// The block as the readings were divided; those without residuals have no sums.
  std::size_t number_of(std::size_t block) const { return sums_[block].number; }

  /// By how much the mean squared residual of every predicted block falls with further columns; empty if those are not
  /// determined without some block.
  std::vector<double> gains_of(const Columns& further) const;
  /// The test of further columns, with the scatter from block to block that is left when they are in the model:
  /// readings of a block may be correlated. None if they are not determined, or by one block only.
  std::optional<TermTest> test(const Columns& further) const;

 private:
  /// Normal equations of one block, and of all readings that may predict it.
  struct BlockSums {
    std::size_t number = 0;
    NormalEquations own, others;
    double residuals = 0;
  };
  /// What predicts one block with the present terms.
  struct Predictor {
    Eigen::MatrixXd inverse;  ///< of the normal matrix of the others, pseudo-inverse over the present parameters
    Eigen::VectorXd step;
    double square = 0;    ///< mean squared residual of the block
    bool usable = false;  ///< the others determine what the block needs
  };
  double square_of(const BlockSums& sums, const Columns& columns, const Eigen::VectorXd& step) const;
  Predictor predictor_of(const BlockSums& sums) const;

  Eigen::VectorXd at_;  // where the sums are taken
  Columns present_;
  std::vector<BlockSums> sums_;
  std::vector<Predictor> predictors_;
  BlockSums whole_;  // all readings
  Predictor whole_predictor_;
};

}  // namespace abbe
