#include "abbe/report/words/scan_plan_words.h"

#include <fmt/format.h>

namespace abbe {

const char* obstacle_words(ScanObstacle obstacle) {
  switch (obstacle) {
    case ScanObstacle::angle:
      return "seen only at more than the largest angle from the normal";
    case ScanObstacle::hidden:
      return "hidden by the part or the stage from all directions";
    case ScanObstacle::working_distance:
      return "the probe would touch; with twice its working distance it would not";
    case ScanObstacle::collision:
      return "the probe would touch the part or the stage";
    case ScanObstacle::travel:
      return "out of the travel of the axes";
    default:
      return "between lines: smaller than their distance";
  }
}

std::string scan_plan_text(const Machine& machine, const ScanPlan& plan, const std::string& name) {
  std::string text;
  text += fmt::format("{} on {}: {} faces\n", name, machine.name, plan.faces.size());
  text += fmt::format("  {:>4} {:<7}{:>12}{:>10}{:>7}{:>9}{:>9}{:>8}{:>8}  {}\n", "face", "path", "area mm2", "covered",
                      "lines", "points", "per mm2", "tilted", "missed", "because");
  constexpr std::size_t kMost = 60;
  for (std::size_t i = 0; i < plan.faces.size() && i < kMost; ++i) {
    const PlannedFace& f = plan.faces[i];
    text += fmt::format("  {:>4} {:<7}{:>12.3f}{:>8.1f} %{:>7}{:>9}{:>9.2f}{:>8}{:>8}  {}\n", i + 1,
                        scan_path_name(f.kind), f.area, f.area > 0 ? 100 * f.covered / f.area : 0, f.lines, f.points,
                        f.points_per_mm2(), f.tilted, f.missed_places(), f.why);
  }
  if (plan.faces.size() > kMost) text += fmt::format("  ... {} more; --json has all\n", plan.faces.size() - kMost);
  text += fmt::format("{} points, {} places not reached, {:.1f} % of {:.1f} mm2 covered\n", plan.points(),
                      plan.missed_places(), 100 * plan.covered_share(), plan.area());
  for (std::size_t k = 1; k < kScanObstacleCount; ++k) {
    const auto obstacle = static_cast<ScanObstacle>(k);
    const double area = plan.uncovered(obstacle);
    if (area > 0)
      text += fmt::format("  not covered {:>6.2f} %: {}\n", 100 * area / plan.area(), obstacle_words(obstacle));
  }
  text += fmt::format("time {:.0f} s; surface at most {:.1f} um from the middle of the range half way between points\n",
                      plan.time, 1e3 * plan.largest_sag);
  if (plan.beyond_range > 0) {
    text += fmt::format("{} moves go around because half way the surface would leave the range: smaller --along-mm\n",
                        plan.beyond_range);
  }
  if (plan.blocked_links > 0) {
    text += fmt::format(
        "{} ways between lines are not clear: the probe may touch the part or the stage there; the path marks them as "
        "blocked, the program stops before each (M0)\n",
        plan.blocked_links);
  }
  return text;
}

}  // namespace abbe
