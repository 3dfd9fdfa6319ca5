#include "abbe/verify/parts/test_piece_deviation.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace abbe {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

/// Part of a sample's way that has to go along the curve for a cut.
constexpr double kAlong = 0.5;

/// The curve of the functional point as a line of straight pieces.
struct ToolCurve {
  std::vector<Vector3d> points;
  std::vector<double> along;   // [points]
  std::vector<double> length;  // [points] of the tool between foot and head

  explicit ToolCurve(const TestPiece& piece) {
    for (std::size_t k = 0; k < piece.curve.points.size(); ++k) {
      points.push_back(piece.curve.points[k].point);
      along.push_back(k == 0 ? 0 : along.back() + (points[k] - points[k - 1]).norm());
      const Ruling& ruling = piece.rulings[k];
      length.push_back((ruling.head + piece.tool_radius * ruling.head_normal - points[k]).norm());
    }
  }

  double end() const { return along.back(); }
};

struct CurvePlace {
  std::size_t segment = 0;
  double fraction = 0;
  double along = 0;
  double distance = std::numeric_limits<double>::infinity();
};

/// The nearest place not before another one, and no farther than `window` behind it.
CurvePlace nearest(const ToolCurve& curve, const CurvePlace& from, const Vector3d& point, double window) {
  CurvePlace best;
  for (std::size_t s = from.segment; s + 1 < curve.points.size(); ++s) {
    if (s > from.segment && curve.along[s] > from.along + window) break;
    const Vector3d way = curve.points[s + 1] - curve.points[s];
    double fraction = way.dot(point - curve.points[s]) / way.squaredNorm();
    fraction = std::clamp(fraction, s == from.segment ? from.fraction : 0.0, 1.0);
    const double distance = (curve.points[s] + fraction * way - point).norm();
    if (distance < best.distance) {
      best = {s, fraction, curve.along[s] + fraction * way.norm(), distance};
    }
  }
  return best;
}

/// Collects the samples that cut.
class CutSamples {
 public:
  CutSamples(const TestPiece& piece, const ToolCurve& curve, const ToolPlaces& actual, PieceDeviation& result)
      : piece_(piece), curve_(curve), actual_(actual), result_(result) {}

  void add(std::size_t row, const CurvePlace& place) {
    const Ruling &a = piece_.rulings[place.segment], &b = piece_.rulings[place.segment + 1];
    const CurvePoint &from = piece_.curve.points[place.segment], &to = piece_.curve.points[place.segment + 1];
    const double f = place.fraction;
    const auto between = [f](const Vector3d& first, const Vector3d& second) -> Vector3d {
      return (1 - f) * first + f * second;
    };
    const Vector3d foot_normal = between(a.foot_normal, b.foot_normal).normalized();
    const Vector3d head_normal = between(a.head_normal, b.head_normal).normalized();
    const Vector3d tool = between(from.point, to.point);
    const Vector3d direction = between(from.direction, to.direction).normalized();
    const double length = (1 - f) * curve_.length[place.segment] + f * curve_.length[place.segment + 1];
    const auto column = static_cast<Index>(row);
    const Vector3d off = actual_.point.col(column) - tool;
    const Vector3d off_at_head = off + length * (actual_.direction.col(column) - direction);
    result_.rows.push_back(row);
    result_.along.push_back(place.along);
    result_.foot.push_back(foot_normal.dot(off));
    result_.head.push_back(head_normal.dot(off_at_head));
    for (const Vector3d& v : {off, between(a.foot, b.foot), between(a.head, b.head), foot_normal, head_normal, tool,
                              Vector3d((to.point - from.point).normalized())}) {
      numbers_.insert(numbers_.end(), {v.x(), v.y(), v.z()});
    }
  }

  void finish() {
    Eigen::Matrix3Xd* const parts[] = {&result_.contour,     &result_.foot_point,  &result_.head_point,
                                       &result_.foot_normal, &result_.head_normal, &result_.tool,
                                       &result_.tangent};
    const auto count = static_cast<Index>(result_.rows.size());
    constexpr Index kParts = 7;
    for (Index p = 0; p < kParts; ++p) {
      parts[p]->resize(3, count);
      for (Index k = 0; k < count; ++k) {
        parts[p]->col(k) = Vector3d::Map(numbers_.data() + 3 * (kParts * k + p));
      }
    }
  }

 private:
  const TestPiece& piece_;
  const ToolCurve& curve_;
  const ToolPlaces& actual_;
  PieceDeviation& result_;
  std::vector<double> numbers_;
};

/// Part of the curve that each sample stands for: half the way to both neighbours.
std::vector<double> weights(const std::vector<double>& along) {
  std::vector<double> weight(along.size(), 1);
  if (along.size() < 2) return weight;
  for (std::size_t k = 0; k < along.size(); ++k) {
    weight[k] = (along[std::min(k + 1, along.size() - 1)] - along[k == 0 ? 0 : k - 1]) / 2;
  }
  return weight;
}

FlankFigures flank_figures(const std::vector<double>& values, const std::vector<double>& weight) {
  FlankFigures figures;
  if (values.empty()) return figures;
  const auto [lowest, highest] = std::minmax_element(values.begin(), values.end());
  figures.lowest = *lowest;
  figures.highest = *highest;
  double squares = 0, all = 0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    squares += weight[k] * values[k] * values[k];
    all += weight[k];
  }
  figures.rms = all > 0 ? std::sqrt(squares / all) : 0;
  return figures;
}

/// The displacement of the workpiece that foot and head show together.
SmallMotion fit_flank(const PieceDeviation& d, const std::vector<double>& weight) {
  const auto count = static_cast<Index>(d.rows.size());
  Eigen::Matrix3Xd points(3, 2 * count), directions(3, 2 * count);
  Eigen::VectorXd seen(2 * count);
  for (Index k = 0; k < count; ++k) {
    const auto n = static_cast<std::size_t>(k);
    const double w = std::sqrt(weight[n]);
    points.col(2 * k) = d.foot_point.col(k);
    points.col(2 * k + 1) = d.head_point.col(k);
    directions.col(2 * k) = w * d.foot_normal.col(k);
    directions.col(2 * k + 1) = w * d.head_normal.col(k);
    seen[2 * k] = w * d.foot[n];
    seen[2 * k + 1] = w * d.head[n];
  }
  return fit_small_motion(points, directions, seen);
}

/// Two directions across the curve for every sample.
SmallMotion fit_contour(const PieceDeviation& d, const std::vector<double>& weight) {
  const auto count = static_cast<Index>(d.rows.size());
  Eigen::Matrix3Xd points(3, 2 * count), directions(3, 2 * count);
  Eigen::VectorXd seen(2 * count);
  for (Index k = 0; k < count; ++k) {
    const double w = std::sqrt(weight[static_cast<std::size_t>(k)]);
    const Vector3d tangent = d.tangent.col(k), first = tangent.unitOrthogonal(), second = tangent.cross(first);
    for (Index i = 0; i < 2; ++i) {
      points.col(2 * k + i) = d.tool.col(k);
      directions.col(2 * k + i) = w * (i == 0 ? first : second);
      seen[2 * k + i] = directions.col(2 * k + i).dot(d.contour.col(k));
    }
  }
  return fit_small_motion(points, directions, seen);
}

}  // namespace

double FlankFigures::largest() const { return std::max(std::abs(lowest), std::abs(highest)); }

PieceDeviation test_piece_deviation(const TestPiece& piece, const ToolPlaces& actual, double reach) {
  PieceDeviation result;
  const ToolCurve curve(piece);
  result.length = curve.end();
  CutSamples cut(piece, curve, actual, result);
  CurvePlace at;
  bool cutting = false;
  double nearest_start = std::numeric_limits<double>::infinity();
  const auto count = static_cast<std::size_t>(actual.point.cols());
  for (std::size_t row = 0; row < count; ++row) {
    const Vector3d point = actual.point.col(static_cast<Index>(row));
    if (!cutting) {
      const double distance = (point - curve.points.front()).norm();
      if (distance < nearest_start) {
        nearest_start = distance;
        result.row = row;
        result.distance = distance;
      }
    }
    if (row == 0) continue;
    const double way = (point - actual.point.col(static_cast<Index>(row - 1))).norm();
    if (!cutting) {
      // The cut begins at a sample at the first point from which the tool goes on along the curve.
      const CurvePlace before = nearest(curve, CurvePlace{}, actual.point.col(static_cast<Index>(row - 1)), reach);
      at = nearest(curve, before, point, way + reach);
      if (before.distance > reach || at.distance > reach || !(way > 0)) continue;
      if (at.along - before.along < kAlong * way) continue;
      cutting = true;
      cut.add(row - 1, before);
      cut.add(row, at);
      continue;
    }
    const CurvePlace next = nearest(curve, at, point, way + reach);
    if (next.distance > reach) {
      if (at.along >= curve.end() - reach) break;
      result.status = PieceTraceStatus::leaves_piece;
      result.row = row;
      result.distance = next.distance;
      break;
    }
    const bool moves = way > 0 && next.along - at.along >= kAlong * way;
    at = next;
    if (moves) cut.add(row, at);
    if (at.segment + 2 == curve.points.size() && at.fraction >= 1) break;
  }
  cut.finish();
  result.reached = result.along.empty() ? 0 : result.along.back();
  if (result.status == PieceTraceStatus::leaves_piece) return result;
  if (!cutting) {
    result.status = PieceTraceStatus::never_begins;
  } else if (result.reached < curve.end() - reach) {
    result.status = PieceTraceStatus::ends_early;
    result.row = count - 1;
  } else {
    result.status = PieceTraceStatus::done;
  }
  return result;
}

PieceFigures piece_figures(const PieceDeviation& deviation, bool best_fit) {
  PieceFigures figures;
  figures.foot_left = deviation.foot;
  figures.head_left = deviation.head;
  const std::vector<double> weight = weights(deviation.along);
  SmallMotion contour_datum;
  if (best_fit) {
    figures.datum = fit_flank(deviation, weight);
    contour_datum = fit_contour(deviation, weight);
  }
  double sum = 0, all = 0;
  for (std::size_t n = 0; n < deviation.rows.size(); ++n) {
    const auto k = static_cast<Index>(n);
    if (best_fit) {
      figures.foot_left[n] -= deviation.foot_normal.col(k).dot(figures.datum.at(deviation.foot_point.col(k)));
      figures.head_left[n] -= deviation.head_normal.col(k).dot(figures.datum.at(deviation.head_point.col(k)));
    }
    Vector3d off = deviation.contour.col(k);
    if (best_fit) off -= contour_datum.at(deviation.tool.col(k));
    const Vector3d tangent = deviation.tangent.col(k);
    const double distance = (off - tangent.dot(off) * tangent).norm();
    figures.contour.largest = std::max(figures.contour.largest, distance);
    sum += weight[n] * distance;
    all += weight[n];
  }
  if (all > 0) figures.contour.mean = sum / all;
  figures.foot = flank_figures(figures.foot_left, weight);
  figures.head = flank_figures(figures.head_left, weight);
  return figures;
}

}  // namespace abbe
