#pragma once

#include <Eigen/Core>
#include <vector>

#include "abbe/geometry/surface/ray_tracer.h"
#include "abbe/machine/machine.h"
#include "abbe/plan/scans/scan_clearance.h"
#include "abbe/plan/scans/scan_plan.h"
#include "abbe/plan/scans/scan_reach.h"

namespace abbe {

/// Strings measured places together: straight on where that can be done, else back along the beam, over and down again.
class ScanPathBuilder {
 public:
  /// All must outlive this object. @param plan  its moves, positions, time and findings of the ways are filled
  ScanPathBuilder(const Machine& machine, const ScanPlanOptions& options, const ScanClearance& clearance,
                  const RayTracer& part, ScanReachFinder& reach, ScanPlan& plan);

  /// Commands of the last move; zero before the first.
  const std::vector<double>& last() const { return last_; }
  bool has_begun() const { return measured_; }
  const Eigen::Vector3d& last_point() const { return last_point_; }
  const Eigen::Vector3d& last_beam() const { return last_beam_; }

  /// Goes to a place and measures it.
  /// @param continues  it follows the place before on its line
  void measure(PlannedMove move, const std::vector<double>& positions, bool continues);

 private:
  bool goes_straight(const std::vector<double>& positions);
  double sag_half_way(const std::vector<double>& positions) const;
  /// Moves from the last place to near the next one. @returns whether the way is clear
  bool link(const PlannedMove& to, const std::vector<double>& positions);
  bool way_is_clear(const std::vector<double>& from, const std::vector<double>& to) const;
  void step(const PlannedMove& move, const std::vector<double>& positions);
  RigidTransform half_way(const std::vector<double>& positions) const;

  const Machine& machine_;
  const ScanPlanOptions& options_;
  const ScanClearance& clearance_;
  const RayTracer& part_;
  ScanReachFinder& reach_;
  ScanPlan& plan_;
  std::vector<double> last_;
  Eigen::Vector3d last_point_ = Eigen::Vector3d::Zero(), last_beam_ = Eigen::Vector3d::UnitZ();
  bool measured_ = false;
};

}  // namespace abbe
