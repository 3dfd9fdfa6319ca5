#include "abbe/verify/unmodelled_errors.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "abbe/geometry/angle_units.h"
#include "abbe/verify/displacement_fields.h"

namespace abbe {
namespace {

using Index = Eigen::Index;

// As in determined_part(): part of its effect that an error must have beside what is known.
constexpr double kBeside = 1e-3;
// Of unit columns; a direction of the model that is weaker is rounding.
constexpr double kModelRank = 1e-7;
constexpr double kNothing = 1e-10;
constexpr double kNearlyATurn = 0.9 * kTurn;

bool holds_motion(const ErrorSet& errors, std::size_t axis, Component component) {
  return std::any_of(errors.motions.begin(), errors.motions.end(), [&](const ErrorMotion& motion) {
    return motion.axis == axis && motion.component == component && motion.state == kNoState;
  });
}

bool holds_location(const ErrorSet& errors, std::size_t axis, Component component) {
  return std::any_of(errors.locations.begin(), errors.locations.end(), [&](const LocationError& location) {
    return location.axis == axis && location.component == component && location.state == kNoState;
  });
}

/// First and last position of every axis over the poses the model covers, and which those are.
struct Covered {
  std::vector<std::uint8_t> poses;
  std::vector<double> from, to;
};

Covered covered_by(const Machine& machine, const ErrorSet& model, const PoseSource& poses) {
  Covered covered;
  covered.poses.assign(poses.count, 0);
  std::vector<std::vector<double>> axis(poses.axes, std::vector<double>(poses.count));
  std::vector<double*> pointers;
  for (std::vector<double>& values : axis) pointers.push_back(values.data());
  poses.fill(0, poses.count, pointers.data());
  if (!machine.couplings.empty()) {
    const PoseList commands{axis};
    for (std::size_t i = 0; i < poses.axes; ++i) axis[i] = positions_of_axis(machine, commands, i);
  }
  covered.from.assign(poses.axes, 0);
  covered.to.assign(poses.axes, 0);
  bool first = true;
  for (std::size_t k = 0; k < poses.count; ++k) {
    bool inside = true;
    for (std::size_t i = 0; i < poses.axes && inside; ++i) inside = model.covers(i, axis[i][k]);
    if (!inside) continue;
    covered.poses[k] = 1;
    for (std::size_t i = 0; i < poses.axes; ++i) {
      covered.from[i] = first ? axis[i][k] : std::min(covered.from[i], axis[i][k]);
      covered.to[i] = first ? axis[i][k] : std::max(covered.to[i], axis[i][k]);
    }
    first = false;
  }
  return covered;
}

/// Functions of lowest order: P0 to P3 over the range, or two harmonics of a turn.
Basis low_orders(const Axis& axis, double from, double to) {
  Basis basis;
  basis.from = from;
  basis.to = to;
  if (axis.kind == AxisKind::rotary && (axis.endless || to - from > kNearlyATurn)) {
    basis.kind = BasisKind::fourier;
    basis.order = 2;
    basis.period = kTurn;
    // Valid all around.
    basis.to = from + kTurn;
  } else {
    basis.order = 3;
  }
  return basis;
}

/// Linear axes from the last of X, Y, Z on, so that the usual squarenesses come first; then rotary ones in chain order.
std::vector<std::size_t> location_order(const Machine& machine) {
  std::vector<std::size_t> order;
  for (int along = 2; along >= 0; --along) {
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
      Index main = 0;
      machine.axes[i].direction.cwiseAbs().maxCoeff(&main);
      if (machine.axes[i].kind == AxisKind::linear && main == along) order.push_back(i);
    }
  }
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    if (machine.axes[i].kind == AxisKind::rotary) order.push_back(i);
  }
  return order;
}

/// Adds what a column has beside the span to it. @return length of that part
double extend(Eigen::MatrixXd& span, Eigen::MatrixXd column) {
  const double before = column.norm();
  remove_span(span, column);
  remove_span(span, column);
  const double beside = column.norm();
  if (beside > kBeside * before) {
    span.conservativeResize(column.rows(), span.cols() + 1);
    span.rightCols(1) = column / beside;
  }
  return beside;
}

/// All errors of the machine that the model does not hold, in the order of the result.
std::vector<UnmodelledError> candidates(const Machine& machine, const ErrorSet& model, const Covered& covered) {
  std::vector<UnmodelledError> list;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    if (!(covered.to[i] > covered.from[i])) continue;
    for (int c = 0; c < kComponentCount; ++c) {
      const Component component = static_cast<Component>(c);
      if (!holds_motion(model, i, component)) list.push_back({i, component, false, 0});
    }
  }
  for (const std::size_t i : location_order(machine)) {
    for (int c = 0; c < kComponentCount; ++c) {
      const Component component = static_cast<Component>(c);
      const Axis& axis = machine.axes[i];
      if (location_error_is_valid(axis, component) && !is_zero_position_error(axis, component) &&
          !holds_location(model, i, component)) {
        list.push_back({i, component, true, 0});
      }
    }
  }
  return list;
}

}  // namespace

std::vector<UnmodelledError> unmodelled_errors(const Machine& machine, const ErrorSet& model, const PoseSource& poses,
                                               const UnmodelledErrorOptions& options) {
  if (poses.axes != machine.axes.size()) throw std::invalid_argument("unmodelled errors: poses do not fit the machine");
  const Covered covered = covered_by(machine, model, poses);
  std::vector<UnmodelledError> list = candidates(machine, model, covered);
  ErrorSet all = errors_with(machine, model, list, covered.from, covered.to);
  all.set_parameters(std::vector<double>(all.parameter_count(), 0.0));
  // The tool offset error stays out: it is measured whenever a tool is set up.
  std::vector<std::size_t> parameters;
  for (std::size_t p = 0; p + 3 < all.parameter_count(); ++p) parameters.push_back(p);
  const DisplacementFields fields = displacement_fields(machine, all, parameters, poses, covered.poses);
  if (fields.pose.empty()) return {};
  const double root = std::sqrt(static_cast<double>(fields.pose.size()));

  // Parameters of the model: the first motions, and the first locations after all motions.
  std::vector<Index> first_of_motion;
  Index next = 0;
  for (const ErrorMotion& motion : all.motions) {
    first_of_motion.push_back(next);
    next += static_cast<Index>(motion.coefficients.size());
  }
  const Index first_location = next;
  std::vector<Index> known;
  const Index known_motions =
      model.motions.size() < all.motions.size() ? first_of_motion[model.motions.size()] : first_location;
  for (Index p = 0; p < known_motions; ++p) known.push_back(p);
  for (std::size_t l = 0; l < model.locations.size(); ++l) known.push_back(first_location + static_cast<Index>(l));

  Eigen::MatrixXd columns(fields.by_parameter.rows(), 6 + static_cast<Index>(known.size()));
  columns.leftCols(6) = fields.by_motion;
  for (std::size_t k = 0; k < known.size(); ++k) {
    const Eigen::VectorXd column = fields.by_parameter.col(known[k]);
    const double length = column.norm();
    // An error that moves nothing leaves rounding, which is no direction.
    const double scale = length > kNothing * root * std::max(fields.size, 1.0) ? 1 / length : 0.0;
    columns.col(6 + static_cast<Index>(k)) = scale * column;
  }
  Eigen::MatrixXd span = orthonormal_columns(columns, kModelRank);

  // Linear axes are square to each other whichever way all of them stand together: that is the position of rotary axes.
  Eigen::MatrixXd turned = Eigen::MatrixXd::Zero(fields.by_parameter.rows(), 3);
  for (std::size_t l = 0; l < all.locations.size(); ++l) {
    const LocationError& one = all.locations[l];
    if (machine.axes[one.axis].kind == AxisKind::linear && is_rotation(one.component))
      turned.col(static_cast<int>(one.component) - 3) +=
          fields.by_parameter.col(first_location + static_cast<Index>(l));
  }
  Eigen::MatrixXd span_of_linear = span;
  for (Index k = 0; k < 3; ++k) extend(span_of_linear, turned.col(k));

  std::vector<UnmodelledError> result;
  std::size_t motion = model.motions.size();
  Index location = first_location + static_cast<Index>(model.locations.size());
  for (UnmodelledError error : list) {
    const bool angle = is_rotation(error.component);
    const double size = angle ? options.typical_angle : options.typical_length;
    // What errors of this size can do at most on a machine of this size.
    const double possible = root * (angle ? std::max(fields.size, 1.0) : 1.0);
    if (error.is_location) {
      const Eigen::VectorXd column = fields.by_parameter.col(location++);
      const bool linear = machine.axes[error.axis].kind == AxisKind::linear;
      const double beside = extend(linear ? span_of_linear : span, column);
      if (beside <= kBeside * possible) continue;
      if (linear) extend(span, column);
      error.effect = size * beside / root;
    } else {
      const Index first = first_of_motion[motion];
      const std::size_t shapes = all.motions[motion].basis.size();
      const std::size_t begin = first_shape(all.motions[motion].basis);
      ++motion;
      double square = 0, largest = 0;
      for (std::size_t k = begin; k < shapes; ++k) {
        Eigen::MatrixXd column = fields.by_parameter.col(first + static_cast<Index>(k));
        remove_span(span, column);
        square += column.squaredNorm() / static_cast<double>(shapes - begin);
        largest = std::max(largest, column.norm());
      }
      if (largest <= kBeside * possible) continue;
      error.effect = size * std::sqrt(square) / root;
    }
    result.push_back(error);
  }
  return result;
}

ErrorSet errors_without(const ErrorSet& errors, const std::vector<UnmodelledError>& unmodelled) {
  const auto listed = [&](std::size_t axis, Component component, bool is_location) {
    return std::any_of(unmodelled.begin(), unmodelled.end(), [&](const UnmodelledError& error) {
      return error.axis == axis && error.component == component && error.is_location == is_location;
    });
  };
  ErrorSet rest = errors;
  std::erase_if(rest.motions, [&](const ErrorMotion& one) { return listed(one.axis, one.component, false); });
  std::erase_if(rest.locations, [&](const LocationError& one) { return listed(one.axis, one.component, true); });
  return rest;
}

ErrorSet errors_with(const Machine& machine, const ErrorSet& model, const std::vector<UnmodelledError>& unmodelled,
                     const std::vector<double>& from, const std::vector<double>& to) {
  ErrorSet errors = model;
  for (const UnmodelledError& error : unmodelled) {
    if (error.is_location) {
      errors.locations.push_back({error.axis, error.component, 0, 0});
      continue;
    }
    ErrorMotion motion{error.axis, error.component, {}, {}, {}};
    motion.basis = low_orders(machine.axes[error.axis], from[error.axis], to[error.axis]);
    motion.coefficients.assign(motion.basis.size(), 0.0);
    errors.motions.push_back(motion);
  }
  return errors;
}

std::size_t first_shape(const Basis& basis) { return basis.kind == BasisKind::fourier ? 3 : 2; }

}  // namespace abbe
