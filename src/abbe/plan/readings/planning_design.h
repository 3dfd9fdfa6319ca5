#pragma once

// Internal to plan: a choice of readings that can be changed one reading at a time.
#include <Eigen/Core>
#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "abbe/geometry/parallel_blocks.h"
#include "abbe/plan/readings/planning_best.h"
#include "abbe/plan/readings/planning_shares.h"
#include "abbe/plan/readings/planning_space.h"

namespace abbe {

/// Information M = known + sum of A_i'A_i of a choice in seen coordinates, with what each candidate would change.
///
/// Kept for every candidate: W_i = A_i M^-1 A_i' and, for a criterion tr(C M^-1), G_i = A_i M^-1 C M^-1 A_i'. Adding
/// changes M^-1 by -T T', T = M^-1 A' L^-T with L L' = I + W; taking out by +T T' with L L' = I - W (Sherman, Morrison
/// and Woodbury). With X_i = A_i T, Y_i = A_i M^-1 C T and H = T'C T: W_i -= s X X', G_i -= s (X Y' + Y X') - X H X',
/// s = 1 for adding and -1 for taking out. One pass over the candidates serves several changes.
/// Several processes keep these of their own blocks of candidates each, and all the same choice and M^-1; every process
/// makes the same calls, and gets the same answers.
/// Source: Fedorov, Theory of Optimal Experiments (1972), sections 2.5, 2.9 and 3.2; the forms for several rows follow
/// by the matrix inversion lemma.
class PlanDesign {
 public:
  static constexpr std::size_t kMostRows = PlanningCandidates::kMostRows;
  static constexpr double kImpossible = ScoredCandidate::kImpossible;

  /// @param functionals  [m, v]: minimise the sum of their variances; without rows: minimise -log det M
  /// @param in_step      processes that make the same choice
  /// @param fingerprint  of everything that the choice depends on
  PlanDesign(const PlanningSpace& space, const Eigen::MatrixXd& functionals, int threads,
             const WorkInStep& in_step = {}, std::uint64_t fingerprint = 0);

  /// The choice, with repetitions, in the order in which it was made.
  const std::vector<std::size_t>& chosen() const { return chosen_; }
  std::size_t times(std::size_t candidate) const { return times_[candidate]; }
  double cost() const { return cost_; }
  const PlanShares& shares() const { return shares_; }
  /// To be minimised: -log det M, or the sum of variances.
  double objective() const { return objective_; }
  /// Changes of the objective that differ by less are equal: rounding must not choose between readings that are worth
  /// the same, as those of mirrored poses are, or every processor would have a plan of its own.
  double tie() const { return by_variance_ ? kTie * std::abs(objective_) : kTie; }
  /// Changes since the last factorisation.
  std::size_t updates() const { return updates_; }

  /// Takes a choice and factorises its information plus `ridge` times the unit matrix.
  /// @return false, and nothing else is to be called, if that is not positive definite
  bool rebuild(const std::vector<std::size_t>& chosen, double ridge);
  void add(std::size_t candidate);
  /// @param place  index into chosen()
  /// @return false, and nothing is changed, if the rest would not determine everything
  bool remove(std::size_t place);
  bool exchange(std::size_t place, std::size_t candidate);

  /// Change of the objective by adding; at most 0. Known of candidates of this process's blocks.
  double gain(std::size_t candidate) const;
  /// [chosen] change of the objective by taking each out; kImpossible if the rest would not determine everything.
  std::vector<double> losses() const;

  /// Which candidates are allowed: not more than `repeats` times, of a cost up to `most_cost`, eligible, of a group
  /// that is not full.
  struct Allowed {
    const std::vector<unsigned char>* eligible = nullptr;  ///< null: all
    const std::vector<std::uint32_t>* group = nullptr;     ///< null: no groups
    std::vector<unsigned char> full{};                     ///< [groups] 1: no more of this one
    std::size_t repeats = 1;
    double most_cost = std::numeric_limits<double>::infinity();
    bool per_cost = false;
    double ceiling = kImpossible;  ///< of the change: candidates that cannot come below it need not be looked at
  };
  /// The candidate whose adding lowers the objective most; the first of equal ones (tie()).
  ScoredCandidate best_to_add(const Allowed& rules);
  static constexpr std::size_t kMostPlaces = 8;
  /// For each of some places, the candidate that lowers the objective most in the place of the chosen one, with the
  /// change by the whole exchange. One pass over the rows of the candidates serves all places.
  ///
  /// Most candidates are passed over by a bound. With loss_j of the chosen one, gain_i of the other and lambda_j the
  /// largest eigenvalue of W_j, the change is at least
  ///     determinant   loss_j - gain_i - n log(1 + q / n),   n the smaller number of rows
  ///     variance      loss_j - (sqrt(gain_i) + sqrt(q loss_j))^2,   q = |W_ij|^2 / (1 - lambda_j), Frobenius norm
  /// (docs/planning.md), and q itself is at most lambda_j trace(W_i) / (1 - lambda_j), which needs no products at all.
  /// A third bound then decides whether G_ij has to be computed. Candidates that cannot equal the best one found by any
  /// thread so far are passed over too.
  /// @param places  indices into chosen(), at most kMostPlaces
  /// @param rules   [places]
  std::vector<ScoredCandidate> best_instead(std::span<const std::size_t> places, std::span<const Allowed> rules);

 private:
  struct Update {
    std::size_t rows = 0;
    double sign = 1;        // 1: added, -1: taken out
    double change = 0;      // of the objective
    std::size_t first = 0;  // columns of factors_: T from here, then M^-1 C T
    std::size_t end = 0;
    std::array<double, kMostRows * kMostRows> middle{};  // H, [rows, rows]
  };

  /// W_j and G_j of a chosen reading.
  struct Squares {
    std::array<double, kMostRows * kMostRows> w, g;
  };

  /// A chosen reading that is to be exchanged.
  struct Leaving {
    std::size_t candidate = 0, rows = 0;
    std::size_t column = 0;  // its first one
    double loss = 0, root_loss = 0;
    double stretch = 0;  // 1 / (1 - lambda_j)
    double size = 0;     // lambda_j / (1 - lambda_j)
    bool bounded = false;
    Squares squares{};
    std::atomic<double> least = kImpossible;  // lowest change found so far, by any thread
  };

  /// Runs work(block) for all own blocks of candidates.
  template <typename Work>
  void for_own_blocks(const Work& work);
  /// W_j and G_j of a chosen reading, from M^-1, so that no process has to ask another one.
  /// @param solved    M^-1 A_j', [v, rows]
  /// @param weighted  C times that; not used for a determinant
  void find_squares(std::size_t candidate, Eigen::Ref<const Eigen::MatrixXd> solved,
                    Eigen::Ref<const Eigen::MatrixXd> weighted, Squares& squares) const;
  double loss_of(const Squares& squares, std::size_t n) const;
  bool make_update(std::size_t candidate, double sign);
  void commit(double direction);
  void pass();
  /// Memory of this thread for the products of a block, and behind them those of one candidate.
  double* product_memory() const;
  /// A_i times columns, in the memory of this thread.
  /// @param factors  columns, each [stride]
  double* products(std::size_t block, const double* factors, std::size_t columns) const;
  /// G_ij of a candidate and a leaving reading, in the memory of this thread.
  const double* mixed_products(std::size_t candidate, const Leaving& leaving) const;
  void measure(std::size_t candidate);
  void prepare(std::size_t place, const Allowed& rules, Leaving& leaving);
  /// Fills the lists of a block, one for each place.
  void best_in_block(std::size_t block, std::span<const Allowed> rules);
  void best_in_block(std::size_t block, const double* x, Leaving& leaving, const Allowed& rules, PossibleBests& best);
  /// A change above this cannot equal the best one.
  double limit_of(const Leaving& leaving, const Allowed& rules) const;
  bool may_be_better(std::size_t candidate, const Leaving& leaving, double square, double limit) const;
  void change_squares(const Update& update, const double* x, std::size_t n, double* w, double* g) const;
  void refresh_all();
  /// @param x      W_ij, columns x_stride_ apart
  /// @param limit  where the change is not below this, the result may be kImpossible
  double change_by_exchange(const Leaving& leaving, std::size_t candidate, const double* x, double limit) const;
  double change_by_exchange_of_one(const Leaving& leaving, std::size_t candidate, double x, double limit) const;
  double change_by_adding(const double* w, const double* g, std::size_t n) const;
  bool allowed(std::size_t candidate, const Allowed& rules) const;
  ScoredCandidate scored(std::size_t candidate, double change, const Allowed& rules) const;
  /// The best candidate for each of the first places, from the lists of all blocks and processes.
  std::vector<ScoredCandidate> best_of_blocks(std::size_t places) const;
  std::size_t block_count() const { return blocks_.size() - 1; }

  // Far above rounding, below what counts as a gain (PlanningOptions::smallest_gain); of the logarithm of the
  // determinant, or relative.
  static constexpr double kTie = 1e-8;

  const PlanningSpace& space_;
  int threads_;
  PlanShares shares_;
  bool by_variance_;
  std::size_t v_;
  Eigen::MatrixXd weight_;   // C, [v, v]
  Eigen::MatrixXd inverse_;  // M^-1
  Eigen::MatrixXd scratch_;  // [v, rows of one candidate]
  std::vector<std::size_t> chosen_, times_;
  double cost_ = 0, objective_ = 0;
  std::size_t updates_ = 0;
  std::vector<std::size_t> blocks_;  // first candidate of each block
  std::vector<std::size_t> square_;  // [candidates + 1] where W_i and G_i start
  std::vector<double> w_, g_;
  std::vector<double> gain_;      // [candidates] change of the objective by adding
  std::vector<double> size_;      // [candidates] trace of W_i
  std::vector<Leaving> leaving_;  // [kMostPlaces]
  std::size_t leaving_count_ = 0;
  std::size_t leaving_columns_ = 0;    // of all of them, padded
  std::vector<double> solved_;         // M^-1 A_j', columns, each [stride]
  std::vector<double> solved_behind_;  // M^-1 C M^-1 A_j'
  std::vector<double> factors_;        // columns, each [stride]
  std::vector<Update> pending_;        // at most two
  std::size_t product_memory_size_ = 0;
  std::size_t x_stride_ = 0;
  std::vector<PossibleBests> best_;  // [blocks][kMostPlaces]
};

template <typename Work>
void PlanDesign::for_own_blocks(const Work& work) {
  for_each_block(shares_.own_count(), threads_, [this, &work](std::size_t k) { work(shares_.own(k)); });
}

}  // namespace abbe
