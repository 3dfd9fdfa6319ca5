#include "liu/sensitivity.h"

#include <Eigen/Geometry>
#include <cmath>

#include "abbe/errors/actual_pose.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/geometry/decompositions.h"
#include "liu/parts.h"
#include "liu/plan.h"

namespace abbe {
namespace {

enum Group : std::size_t { linear_static, linear_dynamic, rotary_static, rotary_dynamic, tilt, centrifugal };

/// Root mean square of a value that is evenly spread over a range.
double spread(double from, double to) { return std::sqrt((from * from + from * to + to * to) / 3); }

double rms(const Eigen::VectorXd& values) {
  return std::sqrt(values.squaredNorm() / static_cast<double>(values.size()));
}

/// Size of a location error in Table 3, mm and rad.
double found_size(const Machine& machine, const LocationError& location) {
  for (const LocationError& found : liu_errors(machine, LiuUnit::millimetre).locations) {
    if (found.axis == location.axis && found.component == location.component) return std::abs(found.value);
  }
  return 0;
}

}  // namespace

LiuSensitivity liu_sensitivity(const Machine& machine) {
  const ScanPlan plan = liu_plan(machine, liu_cross_cylinder(), {});
  const PoseList poses = measuring_positions(plan);
  std::vector<PlannedMove> places;
  for (const PlannedMove& move : plan.moves) {
    if (move.measures) places.push_back(move);
  }
  const auto count = static_cast<Eigen::Index>(poses.count());

  LiuSensitivity result;
  result.groups = {{{"static errors of linear stages", 2.430},
                    {"dynamic errors of linear stages", 0.367},
                    {"static errors of rotary stages", 73.013},
                    {"dynamic errors of rotary stages", 0.083},
                    {"tilt errors of the workpiece", 17.247},
                    {"centrifugal errors of the workpiece", 6.860}}};
  ErrorSet errors = liu_unknowns(machine);
  for (const char* name : {"X", "Y", "Z"}) {
    const std::size_t axis = machine.find_axis(name);
    for (int c = 0; c < kComponentCount; ++c) {
      const auto component = static_cast<Component>(c);
      if (location_error_is_valid(machine.axes[axis], component)) errors.locations.push_back({axis, component, 0, 0});
    }
  }
  for (const LocationError& location : errors.locations) {
    const bool is_linear = machine.axes[location.axis].kind == AxisKind::linear,
               is_angle = is_rotation(location.component);
    LiuTerm term;
    term.name = location_error_name(machine, location.axis, location.component);
    term.is_angle = is_angle;
    // Squareness of the linear axes is not among the terms of the paper.
    term.group = !is_linear ? rotary_static : is_angle ? result.groups.size() : linear_static;
    term.stated = is_angle ? (is_linear ? 0 : spread(0.01, 0.02) * kDegree) : spread(0, 1e-3);
    term.as_found = is_linear ? (is_angle ? 0 : 1e-3) : found_size(machine, location);
    result.terms.push_back(term);
  }
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const bool is_angle = machine.axes[i].kind == AxisKind::rotary;
    result.terms.push_back({machine.axes[i].name + " (dynamic)", is_angle ? rotary_dynamic : linear_dynamic, is_angle,
                            is_angle ? spread(0.01, 0.02) * kDegree : spread(0, 1e-3),
                            is_angle ? 0.004 * kDegree : 1e-3, 0, 0});
  }
  result.terms.push_back(
      {"tilt about x", tilt, true, spread(0, 5) * kDegree, std::abs(kLiuTable3Clamping[0]) * kDegree, 0, 0});
  result.terms.push_back(
      {"tilt about z", tilt, true, spread(0, 5) * kDegree, std::abs(kLiuTable3Clamping[1]) * kDegree, 0, 0});
  result.terms.push_back({"shift along x", centrifugal, false, spread(0, 0.5), std::abs(kLiuTable3Clamping[2]), 0, 0});
  result.terms.push_back({"shift along z", centrifugal, false, spread(0, 0.5), std::abs(kLiuTable3Clamping[3]), 0, 0});

  // Changes along the normal by every term, and by the six motions of the part.
  const std::size_t locations = errors.locations.size(), axes = machine.axes.size();
  Eigen::MatrixXd change(count, static_cast<Eigen::Index>(result.terms.size()));
  Eigen::Matrix<double, Eigen::Dynamic, 6> rigid(count, 6);
  for (Eigen::Index k = 0; k < count; ++k) {
    const PlannedMove& place = places[static_cast<std::size_t>(k)];
    Deviation deviation;
    Eigen::MatrixXd by_parameters, by_positions;
    tool_deviation(machine, errors, poses.pose(static_cast<std::size_t>(k)), deviation, &by_parameters, &by_positions);
    const Eigen::RowVector3d normal = place.normal.transpose();
    const auto first = static_cast<Eigen::Index>(locations), second = static_cast<Eigen::Index>(locations + axes);
    change.row(k).head(first) = normal * by_parameters.topLeftCorner(3, first);
    change.row(k).segment(first, static_cast<Eigen::Index>(axes)) = normal * by_positions.topRows(3);
    rigid.row(k) << normal, place.point.cross(place.normal).transpose();
    change(k, second) = rigid(k, 3);
    change(k, second + 1) = rigid(k, 5);
    change(k, second + 2) = rigid(k, 0);
    change(k, second + 3) = rigid(k, 2);
  }
  const Ldlt<6> solver(rigid.transpose() * rigid);
  for (std::size_t i = 0; i < result.terms.size(); ++i) {
    LiuTerm& term = result.terms[i];
    const Eigen::VectorXd column = change.col(static_cast<Eigen::Index>(i));
    term.across = rms(column);
    // What changes from point to point at random is no motion of the part.
    const bool is_random = i >= locations && i < locations + axes;
    term.remaining = is_random
                         ? term.across
                         : rms(column - rigid * solver.solve(Eigen::Matrix<double, 6, 1>(rigid.transpose() * column)));
  }
  const auto share = [&](double LiuTerm::*effect, double LiuTerm::*size, double LiuGroup::*out) {
    double sum = 0;
    for (const LiuTerm& term : result.terms) {
      if (term.group < result.groups.size()) sum += term.*effect * term.*size;
    }
    for (const LiuTerm& term : result.terms) {
      if (term.group < result.groups.size()) result.groups[term.group].*out += 100 * (term.*effect * term.*size) / sum;
    }
  };
  share(&LiuTerm::across, &LiuTerm::stated, &LiuGroup::stated);
  share(&LiuTerm::remaining, &LiuTerm::stated, &LiuGroup::stated_remaining);
  share(&LiuTerm::across, &LiuTerm::as_found, &LiuGroup::as_found);
  share(&LiuTerm::remaining, &LiuTerm::as_found, &LiuGroup::as_found_remaining);
  return result;
}

}  // namespace abbe
