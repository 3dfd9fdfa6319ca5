#include "abbe/compensate/program/program_uncertainty.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "abbe/compensate/correction_uncertainty.h"
#include "abbe/compensate/working_axes.h"
#include "abbe/errors/actual_pose.h"
#include "abbe/errors/reversal.h"
#include "abbe/geometry/decompositions.h"

namespace abbe {

Eigen::MatrixXd parameter_covariance(const ErrorSet& errors, const Eigen::MatrixXd& covariance) {
  const auto n = static_cast<Eigen::Index>(errors.parameter_count());
  if (covariance.rows() == n) return covariance;
  const Eigen::MatrixXd stated = stated_variances(errors);
  if (stated.size() == 0) return Eigen::MatrixXd::Zero(n, n);
  return stated;
}

PlaceUncertainty uncertainty_at(const Machine& machine, const ErrorSet& errors, const Eigen::MatrixXd& covariance,
                                const ProgramPlace& place, const std::vector<bool>& moved,
                                std::span<const double> given) {
  PlaceUncertainty result;
  if (covariance.rows() == 0 || covariance.isZero(0)) return result;
  Machine with_tool = machine;
  with_tool.tool_offset -= Eigen::Vector3d(place.tool_length[0], place.tool_length[1], place.tool_length[2]);
  const std::vector<double> position(place.position.begin(),
                                     place.position.begin() + static_cast<std::ptrdiff_t>(machine.axes.size()));
  Deviation deviation;
  Eigen::MatrixXd by_parameters, by_positions;
  tool_deviation(with_tool, errors, position, deviation, &by_parameters, &by_positions, given);
  // An axis stands as if half of its reversal value had been commanded besides, in the direction of its approach.
  const std::size_t first = first_reversal(errors);
  for (std::size_t r = 0; r < errors.reversals.size(); ++r) {
    const Reversal& reversal = errors.reversals[r];
    const Eigen::Matrix<double, 6, 1> by_value =
        0.5 * place.approach[reversal.axis] * by_positions.col(static_cast<Eigen::Index>(reversal.axis));
    by_parameters.col(static_cast<Eigen::Index>(first + r)) = by_value;
    deviation += reversal.value * by_value;
  }
  const Eigen::Matrix<double, 6, 6> spread = by_parameters * covariance * by_parameters.transpose();
  result.stated = true;
  const Eigen::Vector3d shift = deviation.head<3>();
  const Eigen::Matrix3d of_point = spread.topLeftCorner<3, 3>();
  const double variance = shift.norm() > 0 ? shift.normalized().dot(of_point * shift.normalized())
                                           : SymmetricEigen<3>(of_point).eigenvalues()[2];
  result.point = std::sqrt(std::max(0.0, variance));

  std::vector<HeldAxis> held;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    if (!moved[i]) held.push_back({i, 0});
  }
  const WorkingAxes working = working_axes(with_tool, TargetKind::point_and_direction, held);
  // With fewer rotary axes than the direction needs a part of the orientation error stays as a rule.
  const bool follows = place.status == CorrectionStatus::reached ||
                       (place.status == CorrectionStatus::orientation_left && working.turning.size() == 1);
  if (!follows) return result;
  const auto columns = [&](const std::vector<std::size_t>& axes) {
    Eigen::MatrixXd chosen(6, static_cast<Eigen::Index>(axes.size()));
    for (std::size_t k = 0; k < axes.size(); ++k)
      chosen.col(static_cast<Eigen::Index>(k)) = by_positions.col(static_cast<Eigen::Index>(axes[k]));
    return chosen;
  };
  // As the inverse does it: rotary axes take the turn of the tool's direction, the others what is then missing of the
  // point.
  const Eigen::MatrixXd turns = columns(working.turning), reaches = columns(working.reaching);
  const Eigen::MatrixXd together = columns(working.arm);
  Eigen::MatrixXd turned = Eigen::MatrixXd::Zero(turns.cols(), 6), reached;
  const Eigen::Vector3d tool = nominal_workpiece_from_tool(with_tool, position).rotation * machine.tool_direction;
  const Eigen::Vector3d across = tool.unitOrthogonal();
  Eigen::Matrix<double, 2, 6> seen = Eigen::Matrix<double, 2, 6>::Zero();
  seen.row(0).tail<3>() = across.transpose();
  seen.row(1).tail<3>() = tool.cross(across).transpose();
  if (together.cols() > 0) {
    // Those of an arm take point and direction together.
    Eigen::Matrix<double, 5, 6> wanted;
    wanted << Eigen::Matrix<double, 3, 6>::Identity(), seen;
    const CompleteOrthogonal solver(wanted * together);
    if (solver.rank() < std::min(wanted.rows(), together.cols())) return result;
    reached = solver.pseudo_inverse() * wanted;
  } else if (turns.cols() > 0) {
    const CompleteOrthogonal solver(seen * turns);
    if (solver.rank() < turns.cols()) return result;
    turned = solver.pseudo_inverse() * seen;
  }
  if (together.cols() == 0) {
    const CompleteOrthogonal solver(reaches.topRows<3>());
    if (solver.rank() < reaches.cols()) return result;
    Eigen::MatrixXd missing = -turns.topRows<3>() * turned;
    missing.leftCols<3>() += Eigen::Matrix3d::Identity();
    reached = solver.pseudo_inverse() * missing;
  }
  result.axes_known = true;
  // Every axis takes its own reversal value, whether it works or not.
  Eigen::MatrixXd apart = by_parameters;
  Eigen::MatrixXd by_axis = Eigen::MatrixXd::Zero(by_positions.cols(), by_parameters.cols());
  for (std::size_t r = 0; r < errors.reversals.size(); ++r) {
    const auto column = static_cast<Eigen::Index>(first + r);
    const std::size_t axis = errors.reversals[r].axis;
    apart.col(column).setZero();
    by_axis(static_cast<Eigen::Index>(axis), column) = 0.5 * place.approach[axis];
  }
  const auto take = [&](const std::vector<std::size_t>& axes, const Eigen::MatrixXd& by_deviation) {
    for (std::size_t k = 0; k < axes.size(); ++k)
      by_axis.row(static_cast<Eigen::Index>(axes[k])) += by_deviation.row(static_cast<Eigen::Index>(k)) * apart;
  };
  take(working.turning, turned);
  take(together.cols() > 0 ? working.arm : working.reaching, reached);
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const Eigen::RowVectorXd row = by_axis.row(static_cast<Eigen::Index>(i));
    result.axis[i] = std::sqrt(std::max(0.0, row.dot(row * covariance)));
  }
  return result;
}

}  // namespace abbe
