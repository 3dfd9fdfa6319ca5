#pragma once

#include <optional>
#include <vector>

#include "abbe/errors/poses.h"
#include "abbe/instruments/instrument.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// on_from minus on_to on the nominal machine, mm, machine frame.
/// @param positions  [axes] chain order, mm or rad
Eigen::Vector3d nominal_displacement(const Machine& machine, const std::vector<double>& positions, Body from, Body to,
                                     const MeetingPoints& points);

/// Axis commands that bring two points together: on_from (on body `from`) comes to on_to (on body `to`) plus
/// `displacement`, nominal machine.
///
/// Rotary axes and linear axes that need not move stay as in `positions`; the linear axes take the shortest way.
/// @param positions     [axes] start, chain order, mm or rad
/// @param displacement  mm, machine frame
/// @return nothing if the linear axes cannot reach it or it lies outside a travel
std::optional<std::vector<double>> meet(const Machine& machine, const std::vector<double>& positions, Body from,
                                        Body to, const MeetingPoints& points, const Eigen::Vector3d& displacement);

/// A circle of one meeting point about the other: displacement = radius (cos t u + sin t v), t evenly from `from_angle`
/// to `to_angle`, both included.
struct CircleDescription {
  Eigen::Vector3d u = Eigen::Vector3d::UnitX();  ///< unit, machine frame
  Eigen::Vector3d v = Eigen::Vector3d::UnitY();  ///< unit, perpendicular to u
  double radius = 0;                             ///< mm
  double from_angle = 0;                         ///< rad
  double to_angle = 0;                           ///< rad
  std::size_t count = 0;
};

/// @param positions  [axes] of the rotary axes; linear axes: start
/// @throws std::invalid_argument, as follow_plan(): a pose is out of reach (which one is said)
PoseList circle_plan(const Machine& machine, const std::vector<double>& positions, Body from, Body to,
                     const MeetingPoints& points, const CircleDescription& circle);

/// The linear axes follow while the rotary axes go through given positions, so that the meeting points keep the same
/// displacement ("chase the ball").
/// @param rotary  poses whose rotary positions count; linear ones are the start
PoseList follow_plan(const Machine& machine, const PoseList& rotary, Body from, Body to, const MeetingPoints& points,
                     const Eigen::Vector3d& displacement);

/// The same poses `repeats` times; there_and_back: every second time in reverse order.
PoseList repeated(const PoseList& poses, std::size_t repeats, bool there_and_back);

}  // namespace abbe
