#pragma once

#include <Eigen/Core>
#include <optional>
#include <random>
#include <vector>

#include "abbe/geometry/rigid_transform.h"
#include "abbe/geometry/surface/distance_grid.h"

namespace abbe {

/// A pose that brings much of a scan near the surface.
struct PoseCandidate {
  RigidTransform mesh_from_scan;
  double score = 0;  ///< 0 .. 1: mean over the scan of 1 - (distance / reach)^2, zero beyond the reach
};

/// The best of many poses of a scan, all different; each is scored on the grid of distances.
class PoseCandidates {
 public:
  /// @param scan       [3, n] mm; of more than 256 points some at random are scored
  /// @param reach      mm; farther points count nothing
  /// @param diameter   of the part, mm: poses that differ by little of it count as one
  /// @param most       poses kept
  /// @param generator  of the random choice
  PoseCandidates(const DistanceGrid& grid, const Eigen::Matrix3Xd& scan, double reach, double diameter,
                 std::size_t most, std::mt19937_64& generator);

  /// Score of a pose, and the least kept score above which it is given up before all points are counted.
  struct Score {
    double score = 0, given_up_above = 0;
  };

  /// Scores a pose and keeps it if it is among the best.
  void add(const RigidTransform& mesh_from_scan) { add(mesh_from_scan, score(mesh_from_scan)); }
  /// The same of a pose that was scored when it was worth adding, perhaps by another process.
  void add(const RigidTransform& mesh_from_scan, const Score& score);
  /// As many are kept as may be: a pose has to be better than one of them.
  bool is_full() const { return best_.size() >= most_; }
  /// The score of a pose that add() would keep now. If not, it will not keep it later either.
  std::optional<Score> score_worth_adding(const RigidTransform& mesh_from_scan) const {
    const Score found = score(mesh_from_scan);
    return found.score > least() ? std::optional(found) : std::nullopt;
  }
  /// Best first.
  std::vector<PoseCandidate> sorted() const;

 private:
  Score score(const RigidTransform& pose) const;
  double least() const { return best_.size() < most_ ? 0 : least_; }
  bool alike(const RigidTransform& a, const RigidTransform& b) const;

  const DistanceGrid& grid_;
  double reach_ = 0, diameter_ = 0;
  std::size_t most_ = 0;
  Eigen::Vector3d middle_;
  std::vector<Eigen::Vector3d> scored_;
  std::vector<PoseCandidate> best_;
  double least_ = 0;
};

}  // namespace abbe
