#pragma once

#include <Eigen/Core>
#include <optional>

#include "abbe/geometry/surface/closest_point.h"
#include "abbe/geometry/surface/ray_tracer.h"

namespace abbe {

/// What stands in the way of a probe: the beam in front of it and its round rod behind the working distance.
class ScanClearance {
 public:
  enum class Verdict {
    free,
    beam_hidden,
    working_distance,  ///< the probe meets something that it would not meet at twice its working distance
    probe_too_near
  };

  /// @param part, stage  workpiece frame, mm
  /// @param radius       mm, of the rod and the distance that it keeps
  ScanClearance(const TriangleMesh& part, const std::optional<TriangleMesh>& stage, double working_distance,
                double radius, double length);

  /// Probe that measures a point of the part.
  /// @param point  mm, on the surface; @param beam  unit vector from the part to the probe
  Verdict measuring(const Eigen::Vector3d& point, const Eigen::Vector3d& beam) const;
  /// Nothing but the surface itself is in the beam.
  bool sees(const Eigen::Vector3d& point, const Eigen::Vector3d& beam) const;
  /// The rod alone.
  bool probe_fits(const Eigen::Vector3d& point, const Eigen::Vector3d& beam) const;
  /// The rod all the way back along the beam from where it measures.
  /// @param back  mm
  bool draws_back(const Eigen::Vector3d& point, const Eigen::Vector3d& beam, double back) const;
  /// Probe on its way: rod and beam as far as the working distance stay clear.
  bool passing(const Eigen::Vector3d& point, const Eigen::Vector3d& beam) const;

 private:
  struct Obstacle {
    ClosestPointFinder surface;
    RayTracer tracer;
  };
  bool rod_is_clear(const Eigen::Vector3d& point, const Eigen::Vector3d& beam, double from, double to) const;

  Obstacle part_;
  std::optional<Obstacle> stage_;
  double working_distance_, radius_, length_;
};

}  // namespace abbe
