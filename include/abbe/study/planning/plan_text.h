#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "abbe/study/planning/planning.h"

namespace abbe {

/// Columns of a list of planned readings behind those of the axes.
struct PlanColumns {
  bool setup = false, station = false;
  std::string target;  ///< "reflector", "item"; "target" where the set-ups call theirs differently
};

PlanColumns plan_columns(const Study& study);

/// The readings of a plan in the order in which they are to be taken, as CSV.
std::string plan_csv(const Study& study, const StudyPlan& result);

/// Predicted uncertainty over the number of readings, with grids, as a drawing.
std::string plan_svg(const Study& study, const StudyPlan& result);

/// A plan for people; complete lines.
std::string study_plan_text(const Study& study, const StudyPlan& result);

/// The same for programs, "abbe-plan/1"; units in the keys.
nlohmann::ordered_json plan_json(const Study& study, const StudyPlan& result);

}  // namespace abbe
