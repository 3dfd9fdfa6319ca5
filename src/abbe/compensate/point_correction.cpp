#include "abbe/compensate/point_correction.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "abbe/errors/chain_plan.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/geometry/decompositions.h"
#include "abbe/geometry/rotation.h"

namespace abbe {
namespace {

constexpr double kProbe = 100;  // mm
/// Each takes three to four digits off.
constexpr int kSteps = 4;

using Points = std::array<std::vector<double>, 3>;

}  // namespace

KnownTravel known_travel(const Machine& machine, const ErrorSet& errors, std::size_t axis) {
  const Axis& one = machine.axes[axis];
  KnownTravel travel;
  travel.from = one.travel_min;
  travel.to = one.travel_max;
  travel.whole_turn = one.endless;
  if (one.endless) {
    travel.from = 0;
    travel.to = kTurn;
  }
  for (const ErrorMotion& motion : errors.motions) {
    if (motion.axis != axis) continue;
    // What covers both ends covers all between, and a basis that repeats itself covers any place.
    const bool ends = motion.basis.covers(travel.from) && motion.basis.covers(travel.to);
    if (ends) continue;
    travel.narrowed = true;
    travel.whole_turn = false;
    travel.from = std::max(travel.from, motion.basis.from);
    travel.to = std::min(travel.to, motion.basis.to);
  }
  if (!(travel.to > travel.from)) travel.to = travel.from;
  return travel;
}

Machine with_room_beyond_travel(Machine machine) {
  for (Axis& axis : machine.axes) {
    const double room = axis.kind == AxisKind::linear ? 20 : 0.1;
    axis.travel_min -= room;
    axis.travel_max += room;
  }
  return machine;
}

double own_correction(const Machine& machine, const ErrorSet& errors, std::size_t axis, double command) {
  const Axis& one = machine.axes[axis];
  double zero = 0;
  for (const LocationError& location : errors.locations) {
    if (location.axis == axis) zero += location.value * location_effect(one, location.component).zero_position;
  }
  double correction = -zero;
  // The error motion changes by parts in ten thousand of the correction: three steps are at the last bit.
  for (int step = 0; step < 4; ++step) {
    const auto e = errors.evaluate(axis, command + correction);
    double along = 0;
    if (one.kind == AxisKind::linear) {
      along = Eigen::Vector3d(e[0], e[1], e[2]).dot(one.direction);
    } else {
      along = rotation_vector(rotation_from_error_angles({e[3], e[4], e[5]})).dot(one.direction);
    }
    correction = -zero - one.sense() * along;
  }
  return correction;
}

struct PointCorrection::Implementation {
  Implementation(const Machine& given, const ErrorSet& set)
      : machine(given),
        errors(set),
        actual(machine, errors, Body::tool, Body::workpiece),
        nominal(machine, ErrorSet{}, Body::tool, Body::workpiece) {
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
      (machine.axes[i].kind == AxisKind::linear ? linear : rotary).push_back(i);
    }
  }

  /// Functional points at commands, in the workpiece frame; mm. Whether the errors are known there does not count: a
  /// correction may lead out of their range by itself.
  Points points(const ChainPlan& plan, const PoseList& commands, const Eigen::Vector3d& tool) const {
    const std::size_t count = commands.count();
    Points start, seen;
    for (std::size_t c = 0; c < 3; ++c) {
      start[c].assign(count, tool[static_cast<Eigen::Index>(c)]);
      seen[c].resize(count);
    }
    std::vector<const double*> axes;
    for (const std::vector<double>& values : commands.axis) axes.push_back(values.data());
    plan.transform({axes, count}, {start[0].data(), start[1].data(), start[2].data()},
                   {seen[0].data(), seen[1].data(), seen[2].data()});
    return seen;
  }

  Machine machine;
  ErrorSet errors;
  ChainPlan actual, nominal;
  std::vector<std::size_t> linear, rotary;
  bool rotary_corrected = true;
};

PointCorrection::PointCorrection(const Machine& machine, const ErrorSet& errors)
    : implementation_(std::make_unique<Implementation>(machine, errors)) {}
PointCorrection::~PointCorrection() = default;

void PointCorrection::set_rotary_corrected(bool corrected) { implementation_->rotary_corrected = corrected; }

void PointCorrection::evaluate(const PoseList& commands, PoseList& correction) const {
  const Implementation& it = *implementation_;
  const std::size_t axes = it.machine.axes.size(), count = commands.count();
  correction.axis.assign(axes, std::vector<double>(count, 0.0));
  if (count == 0) return;
  PoseList reached = commands;
  if (it.rotary_corrected) {
    for (const std::size_t i : it.rotary) {
      for (std::size_t k = 0; k < count; ++k) {
        reached.axis[i][k] += own_correction(it.machine, it.errors, i, commands.axis[i][k]);
      }
    }
  }
  if (!it.linear.empty()) {
    const Points wanted = it.points(it.nominal, commands, it.machine.tool_offset);
    // A linear axis moves the point along a straight line: its direction in the workpiece frame is a difference over
    // any length. Errors turn it by parts in ten thousand, which the iteration takes.
    std::vector<Points> directions;
    for (const std::size_t i : it.linear) {
      PoseList moved = commands;
      for (double& q : moved.axis[i]) q += kProbe;
      directions.push_back(it.points(it.nominal, moved, it.machine.tool_offset));
    }
    const auto size = static_cast<Eigen::Index>(it.linear.size());
    const Eigen::Vector3d tool = it.machine.tool_offset + it.errors.tool_offset_error;
    std::vector<Eigen::MatrixXd> inverse(count);
    for (std::size_t k = 0; k < count; ++k) {
      const auto same_turn = [&](std::size_t i) { return k > 0 && commands.axis[i][k] == commands.axis[i][k - 1]; };
      if (k > 0 && std::all_of(it.rotary.begin(), it.rotary.end(), same_turn)) {
        inverse[k] = inverse[k - 1];
        continue;
      }
      Eigen::MatrixXd along(3, size);
      for (Eigen::Index a = 0; a < size; ++a) {
        for (std::size_t c = 0; c < 3; ++c) {
          along(static_cast<Eigen::Index>(c), a) =
              (directions[static_cast<std::size_t>(a)][c][k] - wanted[c][k]) / kProbe;
        }
      }
      inverse[k] = CompleteOrthogonal(along, 1e-6).pseudo_inverse();
    }
    for (int step = 0; step < kSteps; ++step) {
      const Points seen = it.points(it.actual, reached, tool);
      for (std::size_t k = 0; k < count; ++k) {
        const Eigen::Vector3d missing(wanted[0][k] - seen[0][k], wanted[1][k] - seen[1][k], wanted[2][k] - seen[2][k]);
        for (Eigen::Index a = 0; a < size; ++a) {
          reached.axis[it.linear[static_cast<std::size_t>(a)]][k] += inverse[k].row(a).dot(missing);
        }
      }
    }
  }
  for (std::size_t i = 0; i < axes; ++i) {
    for (std::size_t k = 0; k < count; ++k) correction.axis[i][k] = reached.axis[i][k] - commands.axis[i][k];
  }
}

}  // namespace abbe
