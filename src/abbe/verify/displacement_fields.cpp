#include "abbe/verify/displacement_fields.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "abbe/errors/actual_pose.h"
#include "abbe/errors/error_states.h"
#include "abbe/errors/reversal.h"
#include "abbe/geometry/decompositions.h"
#include "abbe/verify/parts/deviation_block.h"
#include "abbe/verify/parts/deviation_jacobian.h"

namespace abbe {

using Eigen::Index;

Eigen::MatrixXd orthonormal_columns(const Eigen::MatrixXd& columns, double threshold) {
  if (columns.cols() == 0) return columns;
  PivotedQr qr(columns);
  qr.set_threshold(threshold);
  return qr.orthonormal(qr.rank());
}

void remove_span(const Eigen::MatrixXd& span, Eigen::MatrixXd& from) {
  if (span.cols() > 0) from -= span * (span.transpose() * from).eval();
}

DisplacementFields displacement_fields(const Machine& machine, const ErrorSet& errors,
                                       const std::vector<std::size_t>& parameters, const PoseSource& poses,
                                       const std::vector<std::uint8_t>& covered) {
  if (poses.axes != machine.axes.size() || covered.size() != poses.count) {
    throw std::invalid_argument("displacement fields: poses do not fit the machine");
  }
  DisplacementFields result;
  const DeviationModel model(machine, errors, nullptr, false);
  std::vector<Eigen::Vector3d> points;
  const Index n = static_cast<Index>(parameters.size());
  result.by_parameter.resize(3 * std::count(covered.begin(), covered.end(), std::uint8_t{1}), n);
  Index row = 0;
  DeviationBlock block;
  for (std::size_t index = 0; index < block_count(poses); ++index) {
    load_block(poses, index, block);
    model.evaluate(block, {});
    for_each_deviation_jacobian(model, block, parameters, 3,
                                [&](std::size_t from, Index number, const Eigen::MatrixXd& jacobian) {
                                  for (Index k = 0; k < number; ++k) {
                                    const std::size_t at = from + static_cast<std::size_t>(k);
                                    if (covered[block.first + at] == 0) continue;
                                    result.pose.push_back(block.first + at);
                                    points.emplace_back(block.seen[0][at], block.seen[1][at], block.seen[2][at]);
                                    for (Index c = 0; c < 3; ++c)
                                      result.by_parameter.row(row++) = jacobian.row(c * number + k);
                                  }
                                });
  }
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& point : points) centre += point / static_cast<double>(points.size());
  result.by_motion.resize(row, 6);
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Eigen::Vector3d p = points[k] - centre;
    result.size += p.squaredNorm() / static_cast<double>(points.size());
    result.by_motion.middleRows(3 * static_cast<Index>(k), 3) = displacement_by_motion(p[0], p[1], p[2]);
  }
  result.size = std::sqrt(result.size);
  const double largest = points.empty() ? 1 : result.by_motion.rightCols(3).colwise().norm().maxCoeff();
  if (largest > 0) result.by_motion.rightCols(3) /= largest;
  result.by_motion.leftCols(3) /= std::sqrt(std::max(1.0, static_cast<double>(points.size())));
  return result;
}

DisplacementFields displacement_fields(const Machine& machine, const ErrorSet& errors,
                                       const std::vector<std::size_t>& parameters, const PoseList& poses,
                                       const std::vector<std::uint8_t>& covered) {
  DisplacementFields result = displacement_fields(machine, errors, parameters, pose_source(poses), covered);
  const ReversalShift reversal(errors);
  const auto is_reversal = [&](std::size_t p) { return reversal.axis_of(p) != ReversalShift::npos; };
  if (!reversal.acts_on(poses) || std::none_of(parameters.begin(), parameters.end(), is_reversal)) return result;
  const GivenStates given(machine, errors);
  Deviation deviation;
  Eigen::MatrixXd by_positions;
  for (std::size_t k = 0; k < result.pose.size(); ++k) {
    tool_deviation(machine, errors, poses.pose(result.pose[k]), deviation, nullptr, &by_positions,
                   given.at(poses, result.pose[k]));
    for (std::size_t p = 0; p < parameters.size(); ++p) {
      const std::size_t axis = reversal.axis_of(parameters[p]);
      if (axis == ReversalShift::npos) continue;
      result.by_parameter.block<3, 1>(3 * static_cast<Index>(k), static_cast<Index>(p)) =
          0.5 * poses.approach[axis][result.pose[k]] * by_positions.col(static_cast<Index>(axis)).head<3>();
    }
  }
  return result;
}

}  // namespace abbe
