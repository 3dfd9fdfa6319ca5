#pragma once

// Internal to study: closest points of many points as numbered work.
#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "abbe/geometry/surface/closest_point.h"
#include "abbe/study/job_options.h"

namespace abbe {

/// Number that differs where the surfaces differ.
std::uint64_t fingerprint_of_mesh(const TriangleMesh& mesh);

/// As ClosestPointFinder::closest(), by whom the job says.
/// @param mesh  that of the surface
/// @param job   progress: points that were searched, from any thread
/// @returns nothing where the first one of several processes has the result
/// @throws Stopped
std::optional<std::vector<SurfacePoint>> closest_points(const ClosestPointFinder& surface, const TriangleMesh& mesh,
                                                        const Eigen::Matrix3Xd& points, int threads,
                                                        const JobOptions& job);

/// The same driver for work that also depends on a mesh; none stays none. @param driver  is copied
WorkDriver with_mesh(const WorkDriver& driver, const TriangleMesh& mesh);

}  // namespace abbe
