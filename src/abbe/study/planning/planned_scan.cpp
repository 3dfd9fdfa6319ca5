#include "abbe/study/planning/planned_scan.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "abbe/formats/files/file_name.h"
#include "abbe/formats/machine/machine_couplings.h"
#include "abbe/formats/readings/scan_plan_file.h"
#include "abbe/formats/shapes/closed_part.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/geometry/rotation.h"
#include "abbe/plan/scans/wanted_area.h"
#include "abbe/report/pages/scan_plan_page.h"
#include "abbe/report/words/scan_plan_words.h"

namespace abbe {

RigidTransform part_placement(const Eigen::Vector3d& position_mm, const Eigen::Vector3d& turn_deg) {
  return {rotation_from_error_angles(turn_deg * kDegree), position_mm};
}

HalfSpace beyond_plane(const std::array<double, 4>& plane) {
  const Eigen::Vector3d normal(plane[0], plane[1], plane[2]);
  if (!(normal.norm() > 1e-12) || !std::isfinite(normal.norm()) || !std::isfinite(plane[3])) {
    throw InputError({.field = "--beyond-plane-mm"}, "the normal has no length",
                     "NX NY NZ and D in mm: NX x + NY y + NZ z >= D");
  }
  return {normal.normalized(), plane[3] / normal.norm()};
}

PlannedScan plan_part_scan(const ScanRequest& request, const JobOptions& options) {
  refuse_couplings(request.machine, "a plan of a scan");
  PlannedScan result;
  result.part = closed_part(request.part, request.part_file);
  const double most = wanted_area(result.part, request.scan.wanted) / (request.scan.along * request.scan.between);
  if (most > 5e6) {
    throw InputError({.field = "--along-mm"}, fmt::format("{:.0f} points", most),
                     "at most 5,000,000: larger distances, or a part of the surface (--beyond-plane-mm)");
  }
  result.machine = request.machine;
  result.name = file_name(request.part_file);
  result.scan = request.scan;
  ScanPlanOptions with_progress = request.scan;
  with_progress.progress = stoppable_progress(options);
  stop_if_asked(options.stop);
  result.plan = plan_scan(request.machine, result.part, with_progress);
  if (!(result.plan.area() > 0)) {
    throw InputError({.field = "--beyond-plane-mm"}, "nothing of the part lies there", "planes that leave some of it");
  }
  return result;
}

std::string planned_scan_csv(const PlannedScan& planned) { return scan_plan_csv(planned.machine, planned.plan); }

std::string planned_scan_program(const PlannedScan& planned, const PathProgramOptions& options) {
  return scan_plan_program(planned.machine, planned.plan, "scan of " + planned.name + " on " + planned.machine.name,
                           options);
}

std::string planned_scan_text(const PlannedScan& planned) {
  return scan_plan_text(planned.machine, planned.plan, planned.name);
}

nlohmann::ordered_json planned_scan_json(const PlannedScan& planned) {
  return scan_plan_summary(planned.machine, planned.plan, planned.name);
}

std::string planned_scan_page(const PlannedScan& planned) {
  return scan_plan_page(planned.machine, planned.part, planned.plan, planned.scan, planned.name);
}

}  // namespace abbe
