#include "abbe/verify/parts/contour_error.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

namespace abbe {
namespace {

using Eigen::Vector3d;

constexpr double kAlongCurve = 1e-3;  // sine of the angle of a normal that points along the curve

/// Unit tangents at the middle one of three points of the circle through them, or of the line.
Vector3d circle_tangent(const Vector3d& before, const Vector3d& here, const Vector3d& after) {
  const Vector3d first = here - before, second = after - here;
  const double a = first.norm(), b = second.norm();
  return (first / a * (b / (a + b)) + second / b * (a / (a + b))).normalized();
}

/// Direction at the end of a side whose other end has this one: the side's mirror image of it, as on a circle.
Vector3d mirrored(const Vector3d& side, const Vector3d& other_end) {
  const Vector3d s = side.normalized();
  return 2 * s.dot(other_end) * s - other_end;
}

/// Unit vector to the left of the curve in the surface, or none where the surface's normal does not say it.
std::optional<Vector3d> left_of(const CommandPiece& piece, const CommandCurve::Foot& foot) {
  if (piece.normals.cols() == 0) return std::nullopt;
  const auto before = static_cast<Eigen::Index>(foot.before);
  const Vector3d first = piece.normals.col(before), second = piece.normals.col((before + 1) % piece.normals.cols());
  const Vector3d normal = (1 - foot.share) * first.normalized() + foot.share * second.normalized();
  const Vector3d left = normal.cross(foot.tangent);
  if (!(left.norm() > kAlongCurve)) return std::nullopt;
  return left.normalized();
}

}  // namespace

CommandCurve::CommandCurve(const Eigen::Matrix3Xd& points, bool closed, double corner)
    : size_(points.cols()), closed_(closed) {
  for (Eigen::Index i = 0; i < points.cols(); ++i) points_.emplace_back(points.col(i));
  if (points_.size() < 2) throw std::invalid_argument("a curve has two points at least");
  if (closed) points_.push_back(points_.front());
  const std::size_t pieces = points_.size() - 1;
  for (std::size_t i = 0; i < pieces; ++i) {
    if (!((points_[i + 1] - points_[i]).norm() > 1e-9)) {
      throw std::invalid_argument("points " + std::to_string(i + 1) + " and the one behind it are in the same place");
    }
  }
  // Tangent at each point where the curve is smooth there; zero at corners and ends.
  std::vector<Vector3d> smooth(points_.size(), Vector3d::Zero());
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const bool end = i == 0 || i == pieces;
    if (end && (!closed || pieces < 3)) continue;
    const Vector3d& before = points_[i == 0 ? pieces - 1 : i - 1];
    const Vector3d& after = points_[i == pieces ? 1 : i + 1];
    const Vector3d first = points_[i] - before, second = after - points_[i];
    if (std::atan2(first.cross(second).norm(), first.dot(second)) > corner) continue;
    smooth[i] = circle_tangent(before, points_[i], after);
  }
  for (std::size_t i = 0; i < pieces; ++i) {
    const Vector3d side = points_[i + 1] - points_[i];
    const bool first = !smooth[i].isZero(), second = !smooth[i + 1].isZero();
    const Vector3d leaves = first ? smooth[i] : second ? mirrored(side, smooth[i + 1]) : Vector3d(side.normalized());
    const Vector3d comes = second ? smooth[i + 1] : first ? mirrored(side, smooth[i]) : Vector3d(side.normalized());
    // The length of the derivatives that makes the piece an arc: 4 R tan(turn / 4) with the chord 2 R sin(turn / 2).
    const double turn = std::atan2(leaves.cross(comes).norm(), leaves.dot(comes));
    const double size = side.norm() * (turn < 1e-9 ? 1 : 2 * std::tan(turn / 4) / std::sin(turn / 2));
    leaving_.push_back(size * leaves);
    coming_.push_back(size * comes);
  }
  along_.push_back(0);
  for (std::size_t i = 0; i < pieces; ++i) along_.push_back(along_.back() + arc(i, 1));
}

Vector3d CommandCurve::at(std::size_t i, double t, Vector3d* first, Vector3d* second) const {
  const Vector3d& a = points_[i];
  const Vector3d side = points_[i + 1] - a;
  // a + t leaving + t^2 (3 side - 2 leaving - coming) + t^3 (leaving + coming - 2 side)
  const Vector3d c2 = 3 * side - 2 * leaving_[i] - coming_[i], c3 = leaving_[i] + coming_[i] - 2 * side;
  if (first != nullptr) *first = leaving_[i] + t * (2 * c2 + 3 * t * c3);
  if (second != nullptr) *second = 2 * c2 + 6 * t * c3;
  return a + t * (leaving_[i] + t * (c2 + t * c3));
}

/// Gauss's rule of five points: exact to roundings for pieces as straight as these.
double CommandCurve::arc(std::size_t i, double to) const {
  constexpr std::array<double, 5> kAt = {-0.906179845938664, -0.5384693101056831, 0, 0.5384693101056831,
                                         0.906179845938664};
  constexpr std::array<double, 5> kWeight = {0.23692688505618908, 0.47862867049936647, 0.5688888888888889,
                                             0.47862867049936647, 0.23692688505618908};
  double length = 0;
  for (std::size_t k = 0; k < kAt.size(); ++k) {
    Vector3d derivative;
    at(i, to * (1 + kAt[k]) / 2, &derivative, nullptr);
    length += kWeight[k] * derivative.norm() * to / 2;
  }
  return length;
}

CommandCurve::Foot CommandCurve::nearest(const Vector3d& point) const {
  Foot best;
  best.distance = HUGE_VAL;
  for (std::size_t i = 0; i + 1 < points_.size(); ++i) {
    // The piece lies within the hull of its control points, which are no further from the chord than this.
    const Vector3d side = points_[i + 1] - points_[i];
    const double slack = (leaving_[i].norm() + coming_[i].norm()) / 3;
    const double along_chord = std::clamp((point - points_[i]).dot(side) / side.squaredNorm(), 0.0, 1.0);
    if ((point - points_[i] - along_chord * side).norm() - slack > best.distance) continue;
    for (const double start : {along_chord, 0.0, 1.0}) {
      double t = start;
      Vector3d first, second;
      for (int iteration = 0; iteration < 50; ++iteration) {
        const Vector3d off = at(i, t, &first, &second) - point;
        const double slope = off.dot(first), bend = first.squaredNorm() + off.dot(second);
        const double next = std::clamp(t - slope / (bend > 0 ? bend : first.squaredNorm()), 0.0, 1.0);
        const bool rests = std::abs(next - t) < 1e-15;
        t = next;
        if (rests) break;
      }
      const Vector3d place = at(i, t, &first, nullptr);
      const double distance = (place - point).norm();
      if (!(distance < best.distance)) continue;
      best.point = place;
      best.tangent = first.normalized();
      best.along = along_[i] + arc(i, t);
      best.distance = distance;
      best.before = i;
      best.share = t;
      const bool open = !(points_.front() - points_.back()).isZero(0);
      const double past = (point - place).dot(best.tangent);
      const bool at_start = i == 0 && t == 0 && past < 0, at_end = i + 2 == points_.size() && t == 1 && past > 0;
      // Beside the end, with a tangent that is not known better, is not beyond it.
      best.beyond_end = open && (at_start || at_end) && std::abs(past) > 0.2 * distance + 1e-6;
    }
  }
  return best;
}

std::vector<ContourDeviation> contour_deviations(std::span<const CommandPiece> pieces, const Eigen::Matrix3Xd& points) {
  if (pieces.empty()) throw std::invalid_argument("deviations from no curve");
  for (const CommandPiece& piece : pieces) {
    if (piece.normals.cols() != 0 && piece.normals.cols() != piece.curve.size()) {
      throw std::invalid_argument("a curve has " + std::to_string(piece.curve.size()) + " points and " +
                                  std::to_string(piece.normals.cols()) + " normals");
    }
  }
  std::vector<ContourDeviation> result;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    CommandCurve::Foot foot;
    ContourDeviation deviation;
    double before = 0;  // mm, length of the pieces before
    for (std::size_t k = 0; k < pieces.size(); ++k) {
      const CommandCurve::Foot here = pieces[k].curve.nearest(points.col(i));
      if (k == 0 || here.distance < foot.distance) {
        foot = here;
        deviation.piece = k;
        deviation.along = before + here.along;
      }
      before += pieces[k].curve.length();
    }
    deviation.distance = foot.distance;
    deviation.beyond_end = foot.beyond_end;
    const CommandPiece& piece = pieces[deviation.piece];
    if (const std::optional<Vector3d> left = left_of(piece, foot)) {
      deviation.across = left->dot(points.col(i) - foot.point);
      deviation.off = foot.tangent.cross(*left).dot(points.col(i) - foot.point);
    }
    result.push_back(deviation);
  }
  return result;
}

ContourFigures contour_figures(std::span<const double> errors, std::span<const double> uncertainties, double common) {
  std::vector<double> amounts;
  for (const double e : errors) amounts.push_back(std::abs(e));
  ContourFigures figures;
  figures.amounts = sample_statistics(amounts);
  const SampleStatistics& s = figures.amounts;
  if (s.count == 0) return figures;
  const auto n = static_cast<double>(s.count);
  double mean_square = 0, deviation_square = 0, signs = 0, signed_part = 0;
  for (std::size_t i = 0; i < amounts.size(); ++i) {
    const double u = uncertainties.empty() ? 0 : uncertainties[i], sign = errors[i] < 0 ? -1 : 1;
    const double share = s.deviation > 0 && s.count > 1 ? (amounts[i] - s.mean) / (s.deviation * (n - 1)) : 0;
    mean_square += u * u / (n * n);
    figures.bias += errors[i] / n;
    deviation_square += share * share * u * u;
    signs += sign / n;
    signed_part += share * sign;
  }
  figures.mean_uncertainty = std::sqrt(mean_square + signs * signs * common * common);
  figures.bias_uncertainty = std::sqrt(mean_square + common * common);
  figures.deviation_uncertainty = std::sqrt(deviation_square + signed_part * signed_part * common * common);
  figures.largest_uncertainty = std::hypot(uncertainties.empty() ? 0 : uncertainties[s.maximum_at], common);
  return figures;
}

}  // namespace abbe
