// Names and sums of a planned scan, apart from the planner: readers of its files need no more.
#include <array>
#include <numeric>

#include "abbe/plan/scans/scan_plan.h"

namespace abbe {

const char* scan_path_name(ScanPathKind kind) {
  switch (kind) {
    case ScanPathKind::rotary:
      return "rotary";
    case ScanPathKind::raster:
      return "raster";
    case ScanPathKind::free:
      break;
  }
  return "free";
}

const char* scan_obstacle_name(ScanObstacle obstacle) {
  constexpr std::array<const char*, kScanObstacleCount> kNames = {"covered",   "angle",  "hidden", "working_distance",
                                                                  "collision", "travel", "spacing"};
  return kNames[static_cast<std::size_t>(obstacle)];
}

std::size_t PlannedFace::missed_places() const { return std::accumulate(missed.begin(), missed.end(), std::size_t{0}); }

std::size_t ScanPlan::points() const {
  return std::accumulate(faces.begin(), faces.end(), std::size_t{0},
                         [](std::size_t sum, const PlannedFace& face) { return sum + face.points; });
}

std::size_t ScanPlan::missed_places() const {
  return std::accumulate(faces.begin(), faces.end(), std::size_t{0},
                         [](std::size_t sum, const PlannedFace& face) { return sum + face.missed_places(); });
}

double ScanPlan::area() const {
  return std::accumulate(faces.begin(), faces.end(), 0.0,
                         [](double sum, const PlannedFace& face) { return sum + face.area; });
}

double ScanPlan::covered_share() const {
  const double covered = std::accumulate(faces.begin(), faces.end(), 0.0,
                                         [](double sum, const PlannedFace& face) { return sum + face.covered; });
  return area() > 0 ? covered / area() : 0;
}

double ScanPlan::uncovered(ScanObstacle obstacle) const {
  return std::accumulate(faces.begin(), faces.end(), 0.0, [&](double sum, const PlannedFace& face) {
    return sum + face.uncovered[static_cast<std::size_t>(obstacle)];
  });
}

}  // namespace abbe
