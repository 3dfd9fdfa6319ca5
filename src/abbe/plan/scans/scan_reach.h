#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "abbe/machine/inverse_kinematics.h"
#include "abbe/machine/machine.h"
#include "abbe/plan/scans/scan_clearance.h"
#include "abbe/plan/scans/scan_plan.h"

namespace abbe {

/// From where, and with which commands, a place is measured.
struct ScanReach {
  ScanObstacle obstacle = ScanObstacle::none;
  bool tilted = false;  ///< not from the direction tried first
  Eigen::Vector3d beam = Eigen::Vector3d::UnitZ();
  std::vector<double> positions;  ///< [axes] mm or rad
};

/// Finds directions of the beam and commands of the axes for places of a surface.
class ScanReachFinder {
 public:
  /// @param clearance, machine  must outlive this object
  ScanReachFinder(const Machine& machine, const ScanClearance& clearance, double largest_angle);

  /// Tries the first direction, then the normal and those tilted from it by half of and by the whole largest angle,
  /// those nearest to `before` first.
  /// @param point, normal, first, before  mm and unit vectors, workpiece frame; before: the beam at the place before
  /// @param start                 [axes] commands near which the solution is sought
  ScanReach find(const Eigen::Vector3d& point, const Eigen::Vector3d& normal, const Eigen::Vector3d& first,
                 const Eigen::Vector3d& before, const std::vector<double>& start);

  /// Commands that bring the functional point to a point, within travel. @returns false if there are none
  bool commands(const Eigen::Vector3d& point, const Eigen::Vector3d& beam, const std::vector<double>& start,
                std::vector<double>& positions);

 private:
  ScanObstacle attempt(const Eigen::Vector3d& point, const Eigen::Vector3d& beam, const std::vector<double>& start,
                       std::vector<double>& positions);
  bool is_seen_more_steeply(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) const;

  const ScanClearance& clearance_;
  double largest_angle_;
  InverseKinematics inverse_;
  InverseResult result_;
};

}  // namespace abbe
