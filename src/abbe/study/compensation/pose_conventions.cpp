#include "abbe/study/compensation/pose_conventions.h"

#include <algorithm>
#include <cmath>

#include "abbe/errors/actual_pose.h"
#include "abbe/errors/error_states.h"
#include "abbe/geometry/decompositions.h"
#include "abbe/geometry/singular_values.h"
#include "abbe/instruments/measurement_plan.h"
#include "abbe/verify/known_range.h"

namespace abbe {
namespace {

using Index = Eigen::Index;

// A combination of errors whose effect is below this part of the largest changes no pose. At errors of zero it is
// either rounding or real.
constexpr double kNoEffect = 1e-9;
constexpr std::size_t kLeastPoses = 200, kMostPoses = 2000;

ErrorSet at_zero(ErrorSet errors) {
  for (ErrorMotion& motion : errors.motions) {
    if (motion.basis.kind == BasisKind::table_monotone) motion.basis.kind = BasisKind::table_linear;
  }
  errors.set_parameters(std::vector<double>(errors.parameter_count(), 0.0));
  return errors;
}

/// Derivatives of the tool's pose by the errors at poses over their range, without what one rigid motion of the
/// workpiece and one of the tool explain.
/// @param column_norms  [p] before these are taken out
Eigen::MatrixXd pose_derivatives(const Machine& machine, const ErrorSet& errors, const PoseList& poses,
                                 Eigen::VectorXd& column_norms) {
  const Index count = static_cast<Index>(poses.count()), p = static_cast<Index>(errors.parameter_count());
  Eigen::MatrixXd derivatives(6 * count, p), datum = Eigen::MatrixXd::Zero(6 * count, 12);
  std::vector<Eigen::Vector3d> points;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (Index k = 0; k < count; ++k) {
    const std::vector<double> positions = poses.pose(static_cast<std::size_t>(k));
    Deviation deviation;
    Eigen::MatrixXd by_parameters;
    tool_deviation(machine, errors, positions, deviation, &by_parameters);
    derivatives.middleRows(6 * k, 6) = by_parameters;
    const RigidTransform pose = nominal_workpiece_from_tool(machine, positions);
    points.push_back(pose.translation);
    centre += pose.translation / static_cast<double>(count);
    datum.block<3, 3>(6 * k, 6) = pose.rotation;
    datum.block<3, 3>(6 * k + 3, 9) = pose.rotation;
  }
  double size = 0;
  for (const Eigen::Vector3d& point : points) size += (point - centre).squaredNorm() / static_cast<double>(count);
  size = std::max(std::sqrt(size), 1.0);
  for (Index k = 0; k < count; ++k) {
    const Eigen::Vector3d at = points[static_cast<std::size_t>(k)] - centre;
    datum.block<3, 3>(6 * k, 0).setIdentity();
    datum.block<3, 3>(6 * k, 3) << 0, at.z(), -at.y(), -at.z(), 0, at.x(), at.y(), -at.x(), 0;
    datum.block<3, 3>(6 * k, 3) /= size;
    datum.block<3, 3>(6 * k + 3, 3) = Eigen::Matrix3d::Identity() / size;
    // A radian weighs as much as the displacement that it makes over the workspace.
    derivatives.middleRows(6 * k + 3, 3) *= size;
    datum.middleRows(6 * k + 3, 3) *= size;
  }
  column_norms = derivatives.colwise().norm();
  PivotedQr qr(datum);
  qr.set_threshold(1e-9);
  const Eigen::MatrixXd taken = qr.orthonormal(qr.rank());
  for (int pass = 0; pass < 2; ++pass) derivatives -= taken * (taken.transpose() * derivatives).eval();
  return derivatives;
}

/// Errors without a state, and where their parameters are among those of all.
ErrorSet without_states(const ErrorSet& errors, std::vector<Index>& at) {
  ErrorSet plain = errors;
  plain.motions.clear();
  plain.locations.clear();
  Index next = 0;
  const auto take = [&](bool is_plain, std::size_t size) {
    for (std::size_t k = 0; k < size; ++k, ++next) {
      if (is_plain) at.push_back(next);
    }
  };
  for (const ErrorMotion& motion : errors.motions) {
    if (motion.state == kNoState) plain.motions.push_back(motion);
    take(motion.state == kNoState, motion.coefficients.size());
  }
  for (const LocationError& location : errors.locations) {
    if (location.state == kNoState) plain.locations.push_back(location);
    take(location.state == kNoState, 1);
  }
  take(true, errors.parameter_count() - static_cast<std::size_t>(next));
  return plain;
}

Eigen::VectorXd spread(const Eigen::VectorXd& values, const std::vector<Index>& at, std::size_t size) {
  Eigen::VectorXd all = Eigen::VectorXd::Zero(static_cast<Index>(size));
  for (std::size_t k = 0; k < at.size(); ++k) all[at[k]] = values[static_cast<Index>(k)];
  return all;
}

}  // namespace

std::vector<GaugeConstraint> pose_conventions(const Machine& machine, const ErrorSet& structure) {
  if (has_states(structure)) {
    std::vector<Index> at;
    std::vector<GaugeConstraint> conventions = pose_conventions(machine, without_states(structure, at));
    for (GaugeConstraint& constraint : conventions) {
      constraint.functional = spread(constraint.functional, at, structure.parameter_count());
      constraint.direction = spread(constraint.direction, at, structure.parameter_count());
    }
    return conventions;
  }
  const ErrorSet errors = at_zero(structure);
  const std::vector<AxisRange> ranges = common_known_ranges(machine, {&errors}, 2);
  if (std::any_of(ranges.begin(), ranges.end(), [](const AxisRange& range) { return range.to < range.from; })) {
    return {};
  }
  std::size_t functions = 0;
  for (const ErrorMotion& motion : errors.motions) functions = std::max(functions, motion.basis.size());
  const std::size_t count = std::min(kMostPoses, std::max({kLeastPoses, errors.parameter_count(), 20 * functions}));
  Eigen::VectorXd norms;
  const Eigen::MatrixXd derivatives = pose_derivatives(machine, errors, random_plan(machine, ranges, count, 1), norms);

  Problem problem;
  problem.machine = machine;
  problem.errors = errors;
  const double largest = norms.size() > 0 ? norms.maxCoeff() : 0;
  for (Index i = 0; i < norms.size(); ++i) {
    if (norms[i] > kNoEffect * largest) problem.machine_parameters.push_back(static_cast<std::size_t>(i));
  }
  const Index n = static_cast<Index>(problem.machine_parameters.size());
  if (n == 0) return {};
  NullSpace unseen;
  unseen.column_norms.resize(n);
  Eigen::MatrixXd scaled(derivatives.rows(), n);
  for (Index i = 0; i < n; ++i) {
    const Index from = static_cast<Index>(problem.machine_parameters[static_cast<std::size_t>(i)]);
    unseen.column_norms[i] = norms[from];
    scaled.col(i) = derivatives.col(from) / norms[from];
  }
  const RightSingular singular = right_singular(scaled);
  Index rank = 0;
  while (rank < n && singular.values[rank] > kNoEffect) ++rank;
  unseen.basis = unseen.column_norms.cwiseInverse().asDiagonal() * singular.vectors.rightCols(n - rank);
  unseen.rank = static_cast<std::size_t>(rank);
  std::vector<GaugeConstraint> conventions = fix_gauge(problem, unseen, Eigen::VectorXd::Zero(n), GaugeChoice::iso);
  for (GaugeConstraint& constraint : conventions) {
    Eigen::VectorXd functional = Eigen::VectorXd::Zero(norms.size()), direction = functional;
    for (Index i = 0; i < n; ++i) {
      const Index to = static_cast<Index>(problem.machine_parameters[static_cast<std::size_t>(i)]);
      functional[to] = constraint.functional[i];
      direction[to] = constraint.direction[i];
    }
    constraint.functional = functional;
    constraint.direction = direction;
  }
  return conventions;
}

}  // namespace abbe
