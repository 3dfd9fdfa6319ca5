#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "abbe/plan/scans/scan_plan.h"
#include "abbe/report/pages/path_data.h"

namespace abbe {

/// Moves of a planned scan as a page plays them: the functional point where the kinematics put it, workpiece frame.
PathPicture path_picture(const Machine& machine, const ScanPlan& plan, const ScanPlanOptions& options);

/// Data of the page (docs/report-data.md): figures, path and coverage on the part where it stands, faces.
/// @param part     frame of the part, mm, as it was planned for
/// @param name     of the part
/// @param threads  0: all; the result does not depend on it
nlohmann::json scan_plan_page_data(const Machine& machine, const TriangleMesh& part, const ScanPlan& plan,
                                   const ScanPlanOptions& options, const std::string& name, int threads = 0);

/// The page itself, HTML.
std::string scan_plan_page(const Machine& machine, const TriangleMesh& part, const ScanPlan& plan,
                           const ScanPlanOptions& options, const std::string& name, int threads = 0);

}  // namespace abbe
