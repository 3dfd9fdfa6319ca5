#pragma once

#include <string>

#include "abbe/geometry/registration/registration.h"
#include "abbe/report/evaluations/evaluation_report.h"
#include "abbe/verify/parts/scan_comparison.h"

namespace abbe {

/// Farther from the surface points are left out of the picture of a registration: a hundredth of the part's extent, mm.
double farthest_shown_mm(const TriangleMesh& part);

/// Page of a registration: pose with uncertainty, what the scan does not fix, and the deviations that are left, on the
/// part. Points that are left out of the picture are counted in it.
/// @param compared  the scan where it was laid, up to farthest_shown_mm(); null: there is no pose
EvaluationReport registration_page(const std::string& title, const Registration& result, const TriangleMesh& part,
                                   const ScanComparison* compared, int threads);

}  // namespace abbe
