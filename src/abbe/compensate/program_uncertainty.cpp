#include "abbe/compensate/program_uncertainty.h"

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <cmath>

#include "abbe/compensate/correction_uncertainty.h"
#include "abbe/errors/actual_pose.h"
#include "abbe/errors/reversal.h"

namespace abbe {
namespace {

/// Terms of one component of one axis and where their coefficients stand among all parameters.
struct Terms {
  std::vector<std::size_t> motion;
  std::vector<std::size_t> first_parameter;
};

Terms terms_of(const ErrorSet& errors, std::size_t axis, Component component) {
  Terms terms;
  std::size_t parameter = 0;
  for (std::size_t m = 0; m < errors.motions.size(); ++m) {
    const ErrorMotion& motion = errors.motions[m];
    if (motion.axis == axis && motion.component == component) {
      terms.motion.push_back(m);
      terms.first_parameter.push_back(parameter);
    }
    parameter += motion.coefficients.size();
  }
  return terms;
}

/// Whether |value| < factor * u at every sampled position where they are not both zero, and there is one.
bool is_uncertain_everywhere(const Machine& machine, const ErrorSet& errors, const Eigen::MatrixXd& covariance,
                             const Terms& terms, double factor) {
  const ErrorMotion& first = errors.motions[terms.motion[0]];
  const Axis& axis = machine.axes[first.axis];
  double from = axis.travel_min, to = axis.travel_max;
  if (axis.endless || !(to > from)) {
    from = first.basis.from;
    to = first.basis.to > from ? first.basis.to : from + first.basis.period;
  }
  std::size_t count = 0;
  for (const std::size_t m : terms.motion) count += errors.motions[m].coefficients.size();
  Eigen::VectorXd values(static_cast<Eigen::Index>(count));
  Eigen::MatrixXd block(values.size(), values.size());
  std::vector<Eigen::Index> parameter;
  for (std::size_t t = 0; t < terms.motion.size(); ++t) {
    for (std::size_t i = 0; i < errors.motions[terms.motion[t]].coefficients.size(); ++i)
      parameter.push_back(static_cast<Eigen::Index>(terms.first_parameter[t] + i));
  }
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    for (Eigen::Index k = 0; k < values.size(); ++k) {
      block(i, k) = covariance(parameter[static_cast<std::size_t>(i)], parameter[static_cast<std::size_t>(k)]);
    }
  }
  bool uncertain = false;
  constexpr int kSamples = 400;
  for (int s = 0; s <= kSamples; ++s) {
    const double position = from + (to - from) * s / kSamples;
    double value = 0;
    std::size_t at = 0;
    for (const std::size_t m : terms.motion) {
      const ErrorMotion& motion = errors.motions[m];
      const std::size_t size = motion.coefficients.size();
      motion.basis.values(position, motion.coefficients, {values.data() + at, size});
      value += motion.basis.evaluate(position, motion.coefficients);
      at += size;
    }
    const double variance = values.dot(block * values);
    // Where all functions are zero, such as a slope in the middle of its range, both are, and nothing is said.
    if (value == 0 && !(variance > 0)) continue;
    if (!(variance > 0) || std::abs(value) >= factor * std::sqrt(variance)) return false;
    uncertain = true;
  }
  return uncertain;
}

}  // namespace

Eigen::MatrixXd parameter_covariance(const ErrorSet& errors, const Eigen::MatrixXd& covariance) {
  const auto n = static_cast<Eigen::Index>(errors.parameter_count());
  if (covariance.rows() == n) return covariance;
  const Eigen::MatrixXd stated = stated_variances(errors);
  if (stated.size() == 0) return Eigen::MatrixXd::Zero(n, n);
  return stated;
}

PlaceUncertainty uncertainty_at(const Machine& machine, const ErrorSet& errors, const Eigen::MatrixXd& covariance,
                                const ProgramPlace& place, const std::vector<bool>& moved) {
  PlaceUncertainty result;
  if (covariance.rows() == 0 || covariance.isZero(0)) return result;
  Machine with_tool = machine;
  with_tool.tool_offset -= Eigen::Vector3d(place.tool_length[0], place.tool_length[1], place.tool_length[2]);
  const std::vector<double> position(place.position.begin(),
                                     place.position.begin() + static_cast<std::ptrdiff_t>(machine.axes.size()));
  Deviation deviation;
  Eigen::MatrixXd by_parameters, by_positions;
  tool_deviation(with_tool, errors, position, deviation, &by_parameters, &by_positions);
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
  if (shift.norm() > 0) {
    const Eigen::Vector3d along = shift.normalized();
    result.point = std::sqrt(std::max(0.0, along.dot(spread.topLeftCorner<3, 3>() * along)));
  }

  // Where the orientation is not wholly corrected, the commands do not follow from the deviation.
  if (place.status != CorrectionStatus::reached) return result;
  // Point, and the two components of the rotation across the tool where a rotary axis works.
  std::vector<std::size_t> working;
  bool turns = false;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    if (!moved[i]) continue;
    working.push_back(i);
    turns = turns || machine.axes[i].kind == AxisKind::rotary;
  }
  const Eigen::Index rows = turns ? 5 : 3;
  Eigen::MatrixXd seen = Eigen::MatrixXd::Zero(rows, 6);
  seen.topLeftCorner<3, 3>().setIdentity();
  if (turns) {
    const Eigen::Vector3d tool = nominal_workpiece_from_tool(with_tool, position).rotation * machine.tool_direction;
    const Eigen::Vector3d across = tool.unitOrthogonal();
    seen.row(3).tail<3>() = across.transpose();
    seen.row(4).tail<3>() = tool.cross(across).transpose();
  }
  Eigen::MatrixXd by_working(6, static_cast<Eigen::Index>(working.size()));
  for (std::size_t k = 0; k < working.size(); ++k)
    by_working.col(static_cast<Eigen::Index>(k)) = by_positions.col(static_cast<Eigen::Index>(working[k]));
  const Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver(seen * by_working);
  if (solver.rank() < std::min(rows, by_working.cols())) return result;
  const Eigen::MatrixXd to_commands = solver.pseudoInverse() * seen;
  const Eigen::MatrixXd command_spread = to_commands * spread * to_commands.transpose();
  result.axes_known = true;
  for (std::size_t k = 0; k < working.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    result.axis[working[k]] = std::sqrt(std::max(0.0, command_spread(i, i)));
  }
  return result;
}

std::vector<LeftOutReversal> leave_out_uncertain_reversals(ErrorSet& errors, const Eigen::MatrixXd& covariance,
                                                           double factor) {
  std::vector<LeftOutReversal> left_out;
  auto parameter = static_cast<Eigen::Index>(first_reversal(errors));
  for (Reversal& reversal : errors.reversals) {
    const double variance = covariance(parameter, parameter);
    ++parameter;
    if (!(variance > 0) || std::abs(reversal.value) >= factor * std::sqrt(variance)) continue;
    left_out.push_back({reversal.axis, std::abs(reversal.value) / std::sqrt(variance)});
    reversal.value = 0;
  }
  return left_out;
}

std::vector<std::string> leave_out_uncertain(const Machine& machine, ErrorSet& errors,
                                             const Eigen::MatrixXd& covariance, double factor) {
  std::vector<std::string> names;
  ErrorSet kept = errors;
  for (std::size_t axis = 0; axis < machine.axes.size(); ++axis) {
    for (int c = 0; c < kComponentCount; ++c) {
      const Component component = static_cast<Component>(c);
      const Terms terms = terms_of(errors, axis, component);
      if (terms.motion.empty() || !is_uncertain_everywhere(machine, errors, covariance, terms, factor)) continue;
      // Zero and not taken away, so that the range over which they are known still counts.
      for (const std::size_t m : terms.motion)
        kept.motions[m].coefficients.assign(kept.motions[m].coefficients.size(), 0.0);
      names.push_back(error_motion_name(machine, axis, component));
    }
  }
  Eigen::Index parameter = 0;
  for (const ErrorMotion& motion : errors.motions) parameter += static_cast<Eigen::Index>(motion.coefficients.size());
  for (LocationError& location : kept.locations) {
    const double variance = covariance(parameter, parameter);
    ++parameter;
    if (!(variance > 0) || std::abs(location.value) >= factor * std::sqrt(variance)) continue;
    location.value = 0;
    names.push_back(location_error_name(machine, location.axis, location.component));
  }
  for (const LeftOutReversal& reversal : leave_out_uncertain_reversals(kept, covariance, factor))
    names.push_back(reversal_name(machine, reversal.axis));
  errors = kept;
  return names;
}

}  // namespace abbe
