#include "abbe/compensate/left_out_errors.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "abbe/compensate/point_correction.h"
#include "abbe/errors/actual_pose.h"
#include "abbe/errors/random_stream.h"
#include "abbe/errors/reversal.h"

namespace abbe {
namespace {

constexpr std::size_t kMostCorners = 64, kPoses = 200;
/// Shifts (mm) and turns (rad) below these are rounding.
constexpr double kNoShift = 1e-9, kNoTurn = 1e-12;

/// Parameters that are left out or kept together.
struct Group {
  std::string name;
  std::vector<Eigen::Index> parameter;
};

struct Terms {
  std::vector<std::size_t> motion;
  Group group;
};

Terms terms_of(const Machine& machine, const ErrorSet& errors, std::size_t axis, Component component) {
  Terms terms;
  Eigen::Index parameter = 0;
  for (std::size_t m = 0; m < errors.motions.size(); ++m) {
    const ErrorMotion& motion = errors.motions[m];
    const bool is_one = motion.axis == axis && motion.component == component;
    if (is_one) terms.motion.push_back(m);
    for (std::size_t i = 0; i < motion.coefficients.size(); ++i, ++parameter) {
      if (is_one) terms.group.parameter.push_back(parameter);
    }
  }
  if (!terms.motion.empty()) terms.group.name = error_motion_name(machine, axis, component);
  return terms;
}

Eigen::MatrixXd block_of(const Eigen::MatrixXd& covariance, const std::vector<Eigen::Index>& parameter) {
  const auto size = static_cast<Eigen::Index>(parameter.size());
  Eigen::MatrixXd block(size, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    for (Eigen::Index k = 0; k < size; ++k)
      block(i, k) = covariance(parameter[static_cast<std::size_t>(i)], parameter[static_cast<std::size_t>(k)]);
  }
  return block;
}

/// Whether |value| < factor * u at every sampled position where they are not both zero, and there is one.
bool is_uncertain_everywhere(const Machine& machine, const ErrorSet& errors, const Eigen::MatrixXd& covariance,
                             const Terms& terms, double factor) {
  const ErrorMotion& first = errors.motions[terms.motion[0]];
  KnownTravel travel = known_travel(machine, errors, first.axis);
  if (!(travel.to > travel.from)) {
    travel.from = first.basis.from;
    travel.to = first.basis.to > travel.from ? first.basis.to : travel.from + first.basis.period;
  }
  Eigen::VectorXd values(static_cast<Eigen::Index>(terms.group.parameter.size()));
  const Eigen::MatrixXd block = block_of(covariance, terms.group.parameter);
  bool uncertain = false;
  constexpr int kSamples = 400;
  for (int s = 0; s <= kSamples; ++s) {
    const double position = travel.from + (travel.to - travel.from) * s / kSamples;
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

bool is_uncertain(double value, double variance, double factor) {
  return variance > 0 && std::abs(value) < factor * std::sqrt(variance);
}

/// Errors that are small against their own uncertainty, one by one.
std::vector<Group> uncertain_groups(const Machine& machine, const ErrorSet& errors, const Eigen::MatrixXd& covariance,
                                    double factor) {
  std::vector<Group> groups;
  for (std::size_t axis = 0; axis < machine.axes.size(); ++axis) {
    for (int c = 0; c < kComponentCount; ++c) {
      const Terms terms = terms_of(machine, errors, axis, static_cast<Component>(c));
      if (!terms.motion.empty() && is_uncertain_everywhere(machine, errors, covariance, terms, factor))
        groups.push_back(terms.group);
    }
  }
  Eigen::Index parameter = 0;
  for (const ErrorMotion& motion : errors.motions) parameter += static_cast<Eigen::Index>(motion.coefficients.size());
  for (const LocationError& location : errors.locations) {
    if (is_uncertain(location.value, covariance(parameter, parameter), factor))
      groups.push_back({location_error_name(machine, location.axis, location.component), {parameter}});
    ++parameter;
  }
  for (const Reversal& reversal : errors.reversals) {
    if (is_uncertain(reversal.value, covariance(parameter, parameter), factor))
      groups.push_back({reversal_name(machine, reversal.axis), {parameter}});
    ++parameter;
  }
  return groups;
}

/// Derivatives of the point (three rows, mm) and of the tool's direction (three, rad) by all parameters at a pose.
struct DerivativesAtPose {
  std::vector<double> position;
  Eigen::MatrixXd by_parameters;         ///< [6, parameters]
  Eigen::Matrix<double, 6, 6> spread{};  ///< covariance of point and direction by all errors
};

std::vector<DerivativesAtPose> places_of(const Machine& machine, const ErrorSet& errors,
                                         const Eigen::MatrixXd& covariance, const std::vector<Eigen::Vector3d>& tools) {
  const std::size_t axes = machine.axes.size();
  std::vector<std::vector<double>> positions;
  RandomStream random(17);
  const std::size_t corners = axes < 6 ? std::size_t{1} << axes : kMostCorners;
  for (std::size_t k = 0; k < corners + kPoses; ++k) {
    std::vector<double> position;
    for (std::size_t i = 0; i < axes; ++i) {
      const KnownTravel travel = known_travel(machine, errors, i);
      double share = random.uniform();
      if (k < corners) share = axes < 6 ? static_cast<double>(k >> i & 1U) : std::round(share);
      position.push_back(travel.from + share * (travel.to - travel.from));
    }
    positions.push_back(std::move(position));
  }
  std::vector<DerivativesAtPose> places;
  Machine with_tool = machine;
  const std::size_t first = first_reversal(errors);
  bool turned = false;
  for (const Eigen::Vector3d& tool : tools) {
    with_tool.tool_offset = tool;
    for (const std::vector<double>& position : positions) {
      DerivativesAtPose place;
      place.position = position;
      Deviation deviation;
      Eigen::MatrixXd by_positions;
      tool_deviation(with_tool, errors, position, deviation, &place.by_parameters, &by_positions);
      // Every other pose without an approach, as they are in maps.
      turned = !turned;
      for (std::size_t r = 0; r < errors.reversals.size(); ++r) {
        const double half = turned ? 0 : random.uniform() < 0.5 ? -0.5 : 0.5;
        place.by_parameters.col(static_cast<Eigen::Index>(first + r)) =
            half * by_positions.col(static_cast<Eigen::Index>(errors.reversals[r].axis));
      }
      const Eigen::Vector3d along = nominal_workpiece_from_tool(with_tool, position).rotation * machine.tool_direction;
      // A turn about the tool itself is nobody's concern.
      place.by_parameters.bottomRows<3>() -= along * (along.transpose() * place.by_parameters.bottomRows<3>()).eval();
      place.spread = place.by_parameters * covariance * place.by_parameters.transpose();
      places.push_back(std::move(place));
    }
  }
  return places;
}

/// The groups together, looked at from all places.
class Together {
 public:
  Together(const Machine& machine, const ErrorSet& errors, const Eigen::MatrixXd& covariance,
           const std::vector<Eigen::Vector3d>& tools)
      : places_(places_of(machine, errors, covariance, tools)) {
    const std::vector<double> values = errors.parameters();
    values_ = Eigen::VectorXd::Map(values.data(), static_cast<Eigen::Index>(values.size()));
    parts_ = std::any_of(machine.axes.begin(), machine.axes.end(),
                         [](const Axis& axis) { return axis.kind == AxisKind::rotary; })
                 ? 2
                 : 1;
  }

  /// Index of the group that goes back; groups.size() if all are small together.
  std::size_t too_large(const std::vector<Group>& groups, double factor) const {
    std::vector<Eigen::Index> all;
    for (const Group& group : groups) all.insert(all.end(), group.parameter.begin(), group.parameter.end());
    double worst = factor;
    std::size_t found = groups.size();
    for (const DerivativesAtPose& place : places_) {
      for (int part = 0; part < parts_; ++part) {
        const auto rows = place.by_parameters.middleRows<3>(3 * part);
        const Eigen::Vector3d moved = moved_by(rows, all);
        const double size = moved.norm();
        if (!(size > (part == 0 ? kNoShift : kNoTurn))) continue;
        const Eigen::Vector3d along = moved / size;
        const double variance = std::max(0.0, along.dot(place.spread.block<3, 3>(3 * part, 3 * part) * along));
        if (size < worst * std::sqrt(variance)) continue;
        worst = variance > 0 ? size / std::sqrt(variance) : HUGE_VAL;
        double most = 0;
        for (std::size_t g = 0; g < groups.size(); ++g) {
          const double adds = along.dot(moved_by(rows, groups[g].parameter));
          if (!(adds > most)) continue;
          most = adds;
          found = g;
        }
      }
    }
    return found;
  }

  void state_largest(const std::vector<Group>& groups, LeftOutErrors& result) const {
    std::vector<Eigen::Index> all;
    for (const Group& group : groups) all.insert(all.end(), group.parameter.begin(), group.parameter.end());
    for (const DerivativesAtPose& place : places_) {
      const double shift = moved_by(place.by_parameters.topRows<3>(), all).norm();
      if (!result.where.empty() && !(shift > result.largest_shift)) continue;
      result.largest_shift = shift;
      result.where = place.position;
    }
  }

 private:
  template <typename Rows>
  Eigen::Vector3d moved_by(const Rows& rows, const std::vector<Eigen::Index>& parameters) const {
    Eigen::Vector3d moved = Eigen::Vector3d::Zero();
    for (const Eigen::Index p : parameters) moved += rows.col(p) * values_[p];
    return moved;
  }

  std::vector<DerivativesAtPose> places_;
  Eigen::VectorXd values_;
  int parts_ = 1;  ///< point; direction too
};

}  // namespace

std::vector<LeftOutReversal> leave_out_uncertain_reversals(ErrorSet& errors, const Eigen::MatrixXd& covariance,
                                                           double factor) {
  std::vector<LeftOutReversal> left_out;
  auto parameter = static_cast<Eigen::Index>(first_reversal(errors));
  for (Reversal& reversal : errors.reversals) {
    const double variance = covariance(parameter, parameter);
    ++parameter;
    if (!is_uncertain(reversal.value, variance, factor)) continue;
    left_out.push_back({reversal.axis, std::abs(reversal.value) / std::sqrt(variance)});
    reversal.value = 0;
  }
  return left_out;
}

LeftOutErrors leave_out_uncertain(const Machine& machine, ErrorSet& errors, const Eigen::MatrixXd& covariance,
                                  double factor, const std::vector<Eigen::Vector3d>& tools) {
  LeftOutErrors result;
  std::vector<Group> groups = uncertain_groups(machine, errors, covariance, factor);
  if (groups.empty()) return result;
  const Together together(machine, errors, covariance,
                          tools.empty() ? std::vector<Eigen::Vector3d>{machine.tool_offset} : tools);
  for (std::size_t back = together.too_large(groups, factor); back < groups.size();
       back = together.too_large(groups, factor)) {
    result.kept.push_back(groups[back].name);
    groups.erase(groups.begin() + static_cast<std::ptrdiff_t>(back));
  }
  if (groups.empty()) return result;
  together.state_largest(groups, result);
  // Zero and not taken away, so that the range over which they are known still counts.
  std::vector<double> values = errors.parameters();
  for (const Group& group : groups) {
    for (const Eigen::Index p : group.parameter) values[static_cast<std::size_t>(p)] = 0;
    result.names.push_back(group.name);
  }
  errors.set_parameters(values);
  return result;
}

}  // namespace abbe
