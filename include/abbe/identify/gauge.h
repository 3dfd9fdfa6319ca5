#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "abbe/identify/levenberg_marquardt.h"
#include "abbe/identify/problem.h"

namespace abbe {

/// How directions are treated that the readings cannot see.
enum class GaugeChoice {
  iso,           ///< fix them by the conventions of ISO 230, see gauge_convention.h
  minimum_norm,  ///< smallest change from the start in scaled parameters
  none           ///< leave them: a rank-deficient problem then ends with that status
};

/// Which of the location errors, the tool offset and the set-up unknowns are fixed where any of them would do.
enum class GaugeOrder {
  convention,  ///< the first in the order of gauge_convention.h
  firmest      ///< what fixes most of what is open: for machines so far from the start that the first cannot be met
};

/// One equation c'x = value that fixes one unseen direction.
struct GaugeConstraint {
  std::string words;                     ///< "mean of EXC over the turn is zero"
  Eigen::VectorXd functional;            ///< c, [p]
  double value = 0;                      ///< mm or rad
  Eigen::VectorXd direction;             ///< [p]: the unseen direction it fixes; functional . direction = 1
  std::vector<std::size_t> inseparable;  ///< entries of the estimates that this direction mixes, largest first
  std::string quantity;                  ///< what the equation sets: "constant of EXZ"; empty: has no name
  bool by_convention = true;             ///< false: no convention fits, smallest change from the start (a lack of data)
  std::string inseparable_words;         ///< "constant of EXZ is not separable from tracker1.x, tool_X"
};

/// The unseen directions of a problem; `basis` holds the truly unseen and the weak ones.
struct NullSpace {
  Eigen::VectorXd column_norms;     ///< [p], D; 0 where the readings do not depend on the parameter at all
  Eigen::VectorXd singular_values;  ///< [p] of J D^-1, decreasing, relative to the largest
  Eigen::MatrixXd basis;            ///< [p, q], orthonormal in scaled parameters D x; in units of D x
  std::size_t rank = 0;             ///< of the Jacobian: singular values above 5e-14
  std::size_t weak = 0;             ///< directions of `basis` that are seen, but below 3e-8: as good as unseen in J'J
  bool refined = false;             ///< found by orthogonal factors of J, not from J'J
};

struct GaugeReport {
  std::size_t parameter_count = 0;
  std::size_t rank_at_start = 0;
  std::size_t weak_at_start = 0;     ///< seen directions that are fixed too, because they are hardly seen
  std::size_t rank_at_solution = 0;  ///< without the constraints
  Eigen::VectorXd singular_values;   ///< at the start, of the column-scaled Jacobian, relative
  std::vector<GaugeConstraint> constraints;
  std::vector<std::string> warnings;  ///< in words, for the report
};

/// Null space of the column-scaled Jacobian at `estimates` (priors included).
///
/// From the eigenvalues of the scaled normal matrix where they are clearly apart; else from the singular values of the
/// factor R of a streaming orthogonal factorisation of J, which tells singular values of 1e-13 (relative) from zero.
NullSpace find_null_space(const Problem& problem, const Eigen::VectorXd& estimates, int threads = 0);
/// The same over an existing stream, with the sums at `estimates` already known.
NullSpace find_null_space(const ReadingStream& stream, const Eigen::VectorXd& estimates, const NormalEquations& sums);

/// Chooses equations that fix the null space, by convention, in the order of gauge_convention.h.
///
/// Each is taken if it fixes a direction that the ones before it leave open; what no convention reaches is fixed by the
/// smallest change from the start and marked (by_convention = false).
/// @param start  [p], set-up unknowns that have to be fixed keep this value
/// @param found  [p], null for none: location errors, tool offset and set-up unknowns that have to be fixed keep this
///               value instead of zero and the start's
std::vector<GaugeConstraint> fix_gauge(const Problem& problem, const NullSpace& null_space,
                                       const Eigen::VectorXd& start, GaugeChoice choice,
                                       GaugeOrder order = GaugeOrder::convention,
                                       const Eigen::VectorXd* found = nullptr);

/// Solutions of all equations, as near to `start` as a move along the unseen directions allows.
ConstrainedSpace constrained_space(const std::vector<GaugeConstraint>& constraints, const Eigen::VectorXd& start,
                                   const Eigen::VectorXd& column_norms);

}  // namespace abbe
