#pragma once

#include <string>

#include "abbe/geometry/point_cloud.h"
#include "abbe/geometry/registration.h"
#include "abbe/report/evaluation_report.h"

namespace abbe {

/// Page of a registration: pose with uncertainty, what the scan does not fix, and the deviations that are left, on the
/// part. Points farther from the surface than a hundredth of the part's extent are left out of the picture, which says
/// so.
/// @param placed   the scan on the part
/// @param surface  of the part
EvaluationReport registration_page(const std::string& title, const Registration& result, const PointCloud& placed,
                                   const TriangleMesh& part, const ClosestPointFinder& surface, int threads);

}  // namespace abbe
