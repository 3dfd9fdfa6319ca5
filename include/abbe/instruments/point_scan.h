#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>

#include "abbe/errors/chain_plan.h"

namespace abbe {

/// The beam of a displacement probe on the tool.
struct ProbeBeam {
  Eigen::Vector3d zero = Eigen::Vector3d::Zero();  ///< mm, point of indication zero, from the gauge point, tool's frame
  Eigen::Vector3d direction = -Eigen::Vector3d::UnitZ();  ///< unit, from the probe to the part, tool's frame
};

/// Points of the workpiece from axis positions and indications of a probe.
///
/// p = workpiece_from_tool(positions) (zero + h direction), with the actual pose of the machine: calibrated axis
/// average lines, directions of the linear axes and every other error that the set holds. For a cradle-type scanner
/// that is the closed form p_w = R_C(-beta) R_A(-alpha) (P_ref0 + E [x, y, z]' - h m0) about the calibrated lines. Many
/// points at a time, on the calling thread; one object may be used by several threads. Source: Liu et al., Sensors 21
/// (2021) 4609, equations 5 to 9, in closed form.
class PointScan {
 public:
  /// @throws std::invalid_argument if the beam's direction is no unit vector
  PointScan(const Machine& machine, const ErrorSet& errors, const ProbeBeam& beam);

  /// Does not allocate.
  /// @param positions   axis commands, mm or rad
  /// @param indication  [count] mm, positive away from the probe
  /// @param points      out, [count] mm, workpiece frame
  /// @param covered     null or out, [count]: 0 where a position lies outside the range of an error motion
  void points(PositionArrays positions, const double* indication, PointArrays points,
              std::uint8_t* covered = nullptr) const;

 private:
  ChainPlan workpiece_from_tool_;
  Eigen::Vector3d zero_, direction_;
};

}  // namespace abbe
