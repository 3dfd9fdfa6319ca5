#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "abbe/errors/poses.h"
#include "abbe/verify/error_map.h"

namespace abbe {

/// Deviations of the functional point at poses, split into what readings determine and what they leave open.
struct DeterminedPart {
  /// [3][poses] what is left of the deviations without rigid motion and unseen directions, mm.
  std::array<std::vector<double>, 3> displacement;
  std::array<std::vector<double>, 3> uncertainty;  ///< [3][poses] standard uncertainty of that part, mm
  std::array<std::vector<double>, 3> open;         ///< [3][poses] the part that lies in unseen directions, mm
  /// Unseen directions that displace the functional point other than as a rigid body, by more than 1e-3 of what errors
  /// of their size can do: columns of `unseen`.
  std::vector<std::size_t> open_directions;
  std::size_t open_rank = 0;  ///< number of independent displacements among them
};

/// Splits deviations by what an identification could see.
///
/// Errors that differ by an unseen direction explain the readings equally well, so neither a value nor an uncertainty
/// belongs to it; a convention chooses one of them. Most such directions are rigid motions of the workpiece, or change
/// nothing at the functional point. The others are open: the volumetric error depends on them and the readings do not
/// say how much. With B the displacements by rigid motions and by unseen directions, [3 poses, 6 + q], the part
///
///     (I - B B^+) d        with the covariance        (I - B B^+) J Cov J' (I - B B^+)'
///
/// is the same whatever convention was chosen, because any two choices differ by B times something. To first order.
///
/// @param errors      at which the derivatives are taken
/// @param covariance  of some of their parameters, [n]
/// @param unseen      [n, q] directions of the same parameters, mm and rad; their part in other unknowns does not count
/// @param poses       of which the approach may be known: reversal values then displace by it
/// @param deviation   at the poses; not covered ones stay 0. Some thousand poses: 3 poses * n numbers are kept
/// @throws std::invalid_argument if sizes do not fit, as error_map()
/// Source: W. Baarda, S-transformations and criterion matrices (1973); P. Teunissen, Zero order design: generalized
/// inverses, adjustment, the datum problem and S-transformations (1985).
DeterminedPart determined_part(const Machine& machine, const ErrorSet& errors, const ParameterCovariance& covariance,
                               const Eigen::MatrixXd& unseen, const PoseList& poses, const ErrorMap& deviation);

/// As in DeterminedPart.
struct OpenDirections {
  std::vector<std::size_t> directions;
  std::size_t rank = 0;
};

/// The open directions alone, where there is nothing to split: only the parameters that `unseen` contains take part,
/// which are usually few.
///
/// @param parameters  of the errors, [n]
/// @param unseen      [n, q]
/// @param covered     per pose: 0 leaves it out
/// @throws std::invalid_argument if sizes do not fit
OpenDirections open_directions(const Machine& machine, const ErrorSet& errors,
                               const std::vector<std::size_t>& parameters, const Eigen::MatrixXd& unseen,
                               const PoseList& poses, const std::vector<std::uint8_t>& covered);

}  // namespace abbe
