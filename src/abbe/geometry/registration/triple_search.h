#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "abbe/geometry/registration/pose_candidates.h"

namespace abbe {

struct TripleSearchOptions {
  std::uint64_t seed = 1;
  std::size_t triples = 14;     ///< of the scan that are tried
  std::size_t candidates = 64;  ///< kept, all different
  double reach_mm = 0;          ///< farther points count nothing
};

/// Rough poses of a scan without normals on a part, without a guess, best first.
///
/// Three points of the scan fix a pose once three points of the part are found that have the same distances. All such
/// triples of the part are tried for each of some triples of the scan, so a few hundred points or fewer are enough,
/// which lie too far apart to show the normals of the surface. Every pose is scored on the grid of distances. Sources:
/// Fischler, Bolles, Comm. ACM 24 (1981) 381 (poses from the fewest points); Chen, Hung, Cheng, IEEE Trans. Pattern
/// Anal. Mach. Intell. 21 (1999) 1229 (triples of points with equal distances).
/// @param part  [3, n] mm, points spread over the surface; at most 4,000
/// @param scan  [3, n] mm
std::vector<PoseCandidate> search_triples(const Eigen::Matrix3Xd& part, const Eigen::Matrix3Xd& scan,
                                          const DistanceGrid& grid, const TripleSearchOptions& options);

}  // namespace abbe
