#pragma once

#include <vector>

#include "abbe/geometry/surface/triangle_mesh.h"
#include "abbe/plan/scans/scan_plan.h"

namespace abbe {

/// Area of what of a surface lies in all half-spaces, mm^2: triangles are cut exactly.
/// @param mesh, wanted  the same frame, mm
double wanted_area(const TriangleMesh& mesh, const std::vector<HalfSpace>& wanted);

}  // namespace abbe
