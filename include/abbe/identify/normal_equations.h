#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <memory>
#include <stop_token>
#include <vector>

#include "abbe/identify/problem.h"
#include "abbe/identify/robust_loss.h"
#include "abbe/identify/sums/sum_of_readings.h"

namespace abbe {

/// Sums over all used readings and priors at one point.
struct NormalEquations {
  Eigen::MatrixXd normal;    ///< [p, p] J'WJ, symmetric; empty if not wanted
  Eigen::VectorXd gradient;  ///< [p] J'Wr: the direction of descent, J of the modelled values; empty if not wanted
  double cost = 0;           ///< sum of losses; half the sum of squares for LossKind::none
  bool finite = false;       ///< everything wanted is finite
};

enum class Wanted { cost, gradient, normal };

/// One block of residuals and Jacobian as the accumulation sees it.
struct ResidualBlock {
  std::size_t observations = 0;
  std::size_t first = 0;  ///< first reading
  std::size_t count = 0;  ///< readings
  int rows = 0;
  const double* jacobian = nullptr;   ///< columns of the estimates below, column * stride + row * count + k
  const double* residuals = nullptr;  ///< row * count + k; readings not used are zero
  std::size_t stride = 0;             ///< padded length of a column
  const std::vector<std::size_t>* estimates = nullptr;  ///< index of every column in the vector of estimates
};

/// Streams over the readings in blocks of at most Observations::kBlockSize; J is never stored.
///
/// Blocks are gathered into pieces (divide_readings()); every piece has its own sums, which are added in order. The
/// result is therefore the same, bit by bit, for every number of threads, and for every number of processes.
class ReadingStream {
 public:
  /// @param threads    0: all
  /// @param summation  empty: this process sums all pieces
  /// @param stop       looked at before every piece
  ReadingStream(const Problem& problem, int threads, Summation summation = {}, std::stop_token stop = {});
  ~ReadingStream();

  /// Sums at `estimates`; leaves the observations there.
  /// @throws SumError if what the summation gives is refused; Stopped if that was asked for; so do the two below
  NormalEquations sums(const Eigen::VectorXd& estimates, const Loss& loss, Wanted wanted) const;

  /// Norms of all readings at `estimates`, in order of observations and readings; not used: negative.
  std::vector<std::vector<double>> norms(const Eigen::VectorXd& estimates) const;

  /// Factor R, [p, p] upper triangular, of the orthogonal factorisation of J with priors and weights at `estimates`.
  Eigen::MatrixXd orthogonal_factor(const Eigen::VectorXd& estimates, const Loss& loss) const;

  /// Values of all pieces of poses at `estimates`, see SumKind::poses. All observations are WeighedObservations.
  /// @param covariance  [p, p] of the estimates
  std::vector<std::vector<double>> pose_sums(const Eigen::VectorXd& estimates, const Eigen::MatrixXd& covariance) const;

  /// Values of some pieces at the present point of the observations, see SumKind; in this process.
  /// @param covariance  [p * p], only for SumKind::poses
  /// @throws Stopped
  std::vector<std::vector<double>> sum_pieces(SumKind kind, const Loss& loss, const std::vector<double>& covariance,
                                              PieceRange range, const SumOptions& options) const;

  /// Calls work(piece, block) for all blocks of a piece in order; pieces run in parallel. In this process.
  void for_each(bool jacobian, const Loss& loss,
                const std::function<void(std::size_t piece, const ResidualBlock& block, double cost)>& work) const;
  std::size_t piece_count() const;
  /// Where the columns of some observations stand among the estimates.
  const std::vector<std::size_t>& columns_of(std::size_t observations) const;
  std::size_t parameter_count() const;
  std::size_t residual_count() const;  ///< used ones, priors not counted

 private:
  struct Implementation;
  std::vector<std::vector<double>> all_pieces(const Eigen::VectorXd& estimates, SumKind kind, const Loss& loss,
                                              const std::vector<double>& covariance) const;
  std::unique_ptr<Implementation> implementation_;
};

/// Adds priors and joint priors at `estimates` to the sums.
void add_priors(const Problem& problem, const Eigen::VectorXd& estimates, NormalEquations& sums);

/// Priors as rows of a Jacobian, [prior rows, p], for orthogonal factors and simulations.
Eigen::MatrixXd prior_rows(const Problem& problem);

/// Residuals that the priors count for.
double prior_residual_count(const Problem& problem);

}  // namespace abbe
