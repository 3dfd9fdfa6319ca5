#include "abbe/formats/shapes/curve_pieces.h"

#include <fmt/format.h>

#include "abbe/formats/text/input_error.h"

namespace abbe {

std::vector<CommandPiece> commanded_pieces(const Curve& curve, const std::string& file, const std::string& closed) {
  const std::vector<WorkingRun> runs = working_runs(curve);
  if (runs.empty()) {
    throw InputError({.file = file}, "the tool does not cut on the way to any of its points",
                     "a curve of two points or more between which it cuts");
  }
  if (!closed.empty() && runs.size() > 1) {
    throw InputError({.field = closed}, fmt::format("the tool works on {} pieces of the curve", runs.size()),
                     "a curve of one piece");
  }
  std::vector<CommandPiece> pieces;
  for (const WorkingRun& run : runs) {
    const auto apart = [&](std::size_t a, std::size_t b) {
      return (curve.points[a].point - curve.points[b].point).norm() >= 1e-9;
    };
    for (std::size_t i = run.first; i < run.last; ++i) {
      if (apart(i, i + 1)) continue;
      throw InputError({.file = file}, fmt::format("point {} and the next one coincide", i + 1),
                       "neighbours apart from each other");
    }
    // A piece that comes back to its first point is closed, and has this point once.
    const bool comes_back = run.last - run.first > 2 && !apart(run.first, run.last);
    const auto n = static_cast<Eigen::Index>(run.last - run.first + (comes_back ? 0 : 1));
    Eigen::Matrix3Xd points(3, n), normals(3, n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const CurvePoint& at = curve.points[run.first + static_cast<std::size_t>(i)];
      points.col(i) = at.point;
      normals.col(i) = at.direction;
    }
    pieces.push_back({CommandCurve(points, !closed.empty() || comes_back), normals});
  }
  return pieces;
}

}  // namespace abbe
