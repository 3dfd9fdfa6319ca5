#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "abbe/geometry/rigid_transform.h"
#include "abbe/geometry/surface/closest_point.h"
#include "abbe/machine/machine.h"
#include "abbe/plan/ways/obstacle.h"

namespace abbe {

/// Where the tool would touch an obstacle.
struct WayCollision {
  std::size_t obstacle = 0;  ///< index into the obstacles
  std::vector<double> pose;  ///< [axes] mm or rad, where it was found
  double share = 0;          ///< of the straight way to there, 0 to 1
  double distance = 0;       ///< mm from the line of the tool to the obstacle; negative: within it
};

/// How a machine may avoid obstacles between two readings. With neither, only straight ways are tried.
struct WayOptions {
  double clearance = 0;  ///< mm; how far the tool may retract along its direction; less where travel ends
  /// Axes, and the commands (mm or rad) at which they are clear of everything.
  std::vector<std::pair<std::size_t, double>> clear_at{};
};

/// A way from one pose to another.
struct Way {
  bool is_clear = false;
  std::vector<std::vector<double>> via;   ///< poses between its ends, in their order; empty: straight
  std::optional<WayCollision> collision;  ///< on the straight way, also where a way around it was found
};

/// Ways of the tool among obstacles.
///
/// A way is a sequence of straight lines in axis commands: all axes begin and end a line together, and their shares of
/// it are equal (linear interpolation). A line is proven to be clear by bisection. At the middle of a piece, the
/// distance of the tool's line from the obstacle is exact. Over the piece no point of that line moves farther in the
/// frame of the obstacle than
///
///     sum over the axes between them of  |dq|  (linear)  or  |dq| (lever + what the axes beyond it move)  (rotary),
///
/// with dq half of the axis's motion over the piece, and lever the distance of the tool's line from the axis in the
/// middle. Where the distance exceeds the radius of the tool by more than this bound, the whole piece is clear; else it
/// is halved. A piece whose bound falls below kTouching counts as a collision, so that a way may be refused which keeps
/// clear by less than kTouching, and none is accepted that does not keep clear. The method is that of adaptive dynamic
/// collision checking: F. Schwarzer, M. Saha, J.-C. Latombe, IEEE Trans. Robotics 21 (2005) 338.
///
/// The machine is the nominal one. Within a closed mesh counts as a collision at any depth; of an open mesh only the
/// surface is known.
class ClearWays {
 public:
  static constexpr double kTouching = 0.01;  ///< mm

  /// @param machine    must outlive the object
  /// @param obstacles  may be empty: then all ways are clear
  ClearWays(const Machine& machine, const std::vector<Obstacle>& obstacles, ToolShape tool, WayOptions options = {});

  /// What the tool touches where it stands; nothing: it is clear by more than kTouching.
  std::optional<WayCollision> standing(const std::vector<double>& pose) const;

  /// What it touches on the straight way, both ends included.
  std::optional<WayCollision> straight(const std::vector<double>& from, const std::vector<double>& to) const;

  /// The straight way if it is clear, or else the first of these that is: with the tool retracted at both ends, and the
  /// rotary axes moved with the others, after or before them; with the axes of WayOptions::clear_at there; both.
  /// Via poses are within the travel.
  Way find(const std::vector<double>& from, const std::vector<double>& to) const;

  /// Axes moved so that the tool retracts along its direction, as far as the options say and travel allows, without
  /// turning. Nothing where linear axes cannot do that, or not at all.
  std::optional<std::vector<double>> retracted(const std::vector<double>& pose) const;

 private:
  struct Surface {
    ClosestPointFinder finder;
    bool is_closed;
    ObstacleCarrier carrier;
    std::size_t axis;
  };
  struct Stand;
  Stand stand(const std::vector<double>& pose) const;
  std::optional<WayCollision> piece(const std::vector<double>& from, const std::vector<double>& to, double begin,
                                    double end) const;
  bool is_clear_along(const std::vector<std::vector<double>>& poses) const;

  const Machine& machine_;
  std::vector<Surface> surfaces_;
  ToolShape tool_;
  WayOptions options_;
};

}  // namespace abbe
