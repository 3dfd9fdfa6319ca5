#pragma once

#include <Eigen/Core>

#include "abbe/identify/linkage/dial_grid.h"

namespace abbe {

/// Equations (3) to (11) of Wang et al. (2020) word for word, for axis X: only to compare with them. They are wrong:
/// (5) and (8) keep the dial's zero and its setting against the guideway, (7) and (10) are constants of that setting
/// and no pitch or yaw, (6) and (9) have opposite signs, so that (11) cancels the roll.
struct DialGridAsPrinted {
  Eigen::VectorXd straightness_z;  ///< (5), [m] mm
  Eigen::VectorXd roll_from_z;     ///< (6), [m] rad
  double pitch = 0;                ///< (7), the same for every position, rad
  Eigen::VectorXd straightness_y;  ///< (8), [m] mm
  Eigen::VectorXd roll_from_y;     ///< (9), [m] rad
  double yaw = 0;                  ///< (10), rad
  Eigen::VectorXd roll;            ///< (11), [m] rad
};

/// @param z_face  normal along the axis after next (axis X: Z), places along the next one
/// @param y_face  the other face, with the same number of positions
/// @throws std::invalid_argument for sizes that do not fit
DialGridAsPrinted decouple_grids_as_printed(const DialGrid& z_face, const DialGrid& y_face);

}  // namespace abbe
