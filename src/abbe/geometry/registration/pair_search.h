#pragma once

#include <cstdint>
#include <vector>

#include "abbe/geometry/numbered_work.h"
#include "abbe/geometry/registration/pose_candidates.h"
#include "abbe/geometry/surface/point_cloud.h"
#include "abbe/geometry/surface/surface_samples.h"

namespace abbe {

struct PairSearchOptions {
  std::uint64_t seed = 1;
  std::size_t poses = 100000;   ///< tried
  std::size_t candidates = 48;  ///< kept, all different
  double reach_mm = 0;          ///< farther points count nothing
  int threads = 0;              ///< 0: all; the result does not depend on it
  WorkDriver work{};            ///< who scores the poses; its fingerprints do not know the surface
};

/// Rough poses of a scan on a part, without a guess, best first.
///
/// Two points of the scan with their normals fix a pose once two points of the part are found that have the same
/// distance and angles. Pairs of the scan that few pairs of the part resemble are tried first; every pose is scored on
/// the grid of distances, so that neither stray points nor parts of the surface that were not scanned matter.
/// Sources: Drost, Ulrich, Navab, Ilic, CVPR (2010) 998 (pair features); Papazov, Burschka, ACCV (2010) 135 (random
/// pairs instead of votes).
/// @param part  [n] points of the surface with normals
std::vector<PoseCandidate> search_poses(const PointCloud& part, const ThinnedScan& scan, const DistanceGrid& grid,
                                        const PairSearchOptions& options);

}  // namespace abbe
