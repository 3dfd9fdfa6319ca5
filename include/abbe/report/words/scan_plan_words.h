#pragma once

#include <string>

#include "abbe/plan/scans/scan_plan.h"

namespace abbe {

/// Why a place is not measured, in words.
const char* obstacle_words(ScanObstacle obstacle);

/// Figures of a plan and of its faces for people; complete lines.
std::string scan_plan_text(const Machine& machine, const ScanPlan& plan, const std::string& name);

}  // namespace abbe
