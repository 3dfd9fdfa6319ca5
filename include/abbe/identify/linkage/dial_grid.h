#pragma once

#include <Eigen/Core>
#include <vector>

#include "abbe/identify/linkage/dial_decoupling.h"

namespace abbe {

/// One dial over m positions of a linear axis times n places across its motion, on one face parallel to the motion.
struct DialGrid {
  std::vector<double> positions;  ///< [m] mm, increasing
  std::vector<double> across;     ///< [n] mm
  Eigen::MatrixXd indications;    ///< [m, n] mm
};

/// Least-squares line a_i + k_i (y - y_ref) in each row of a grid.
struct RowFit {
  Eigen::VectorXd at_reference;  ///< a_i, [m] mm
  Eigen::VectorXd slope;         ///< k_i, [m] rad
  double spread = 0;             ///< w = sum (y - mean)^2, mm^2
};

/// @throws std::invalid_argument for sizes that do not fit or places that are all the same
RowFit fit_rows(const DialGrid& grid, double reference);

/// Values without their least-squares line over the positions. @throws std::invalid_argument for fewer than 3 or equal
/// positions
Eigen::VectorXd without_line(const std::vector<double>& positions, const Eigen::VectorXd& values);

/// Roll from the rows of two faces: (w_y k_z - w_z k_y) / (w_y + w_z), the weighted mean of k_z and -k_y with the
/// smallest uncertainty, u(roll) = u / sqrt(w_y + w_z).
/// @param second  face with its normal along the axis after next in the order X Y Z X Y (axis X: normal Z, places along
///                Y), where the slope is +roll
/// @param first   the other face (axis X: normal Y, places along Z), where it is -roll
Eigen::VectorXd roll_of_rows(const RowFit& second, const RowFit& first);

/// The two grids of an axis as indications of n + n probes, all at the same place along the motion.
/// @param direction             of the axis, 0 X, 1 Y, 2 Z
/// @param standard_uncertainty  of one indication, mm
AxisIndications indications_of_grids(std::size_t direction, const DialGrid& second, const DialGrid& first,
                                     double standard_uncertainty);

}  // namespace abbe
