#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>

#include "abbe/identify/linkage/linkage_steps.h"

namespace abbe {

/// Marks at many poses in one fit (examples/laser_engraver/marks.study.toml), and what it and the five steps leave
/// open.
struct YinJointFit {
  bool converged = false;
  std::string message;
  std::size_t readings = 0;
  double chi_square = 0;
  long degrees_of_freedom = 0;
  SwingHeadLinkage truth, found;  ///< of the simulated machine
  Eigen::Matrix<double, SwingHeadLinkage::kCount, SwingHeadLinkage::kCount> covariance =
      Eigen::Matrix<double, SwingHeadLinkage::kCount, SwingHeadLinkage::kCount>::Zero();  ///< mm^2
  /// Root mean square over random poses of the standard uncertainty of the focus in the table's frame, mm: from this
  /// covariance, from that of the five steps, and from the variances of the five steps alone.
  double focus = 0, focus_by_steps = 0, focus_without_correlations = 0;

  double standard_uncertainty(std::size_t parameter) const;  ///< mm
};

/// @param steps  what the five steps say of the same machine
YinJointFit yin_joint_fit(const LinkageEvaluation& steps);

/// Root mean square over poses of a linkage's part of the focus's standard uncertainty, mm: A to 90 degrees either way,
/// C1 to 180.
double focus_uncertainty(const SwingHeadLinkage& linkage,
                         const Eigen::Matrix<double, SwingHeadLinkage::kCount, SwingHeadLinkage::kCount>& covariance);

}  // namespace abbe
