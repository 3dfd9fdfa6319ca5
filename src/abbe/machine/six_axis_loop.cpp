#include "abbe/machine/six_axis_loop.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "abbe/geometry/decompositions.h"
#include "abbe/geometry/rotation.h"

namespace abbe {

using Eigen::Matrix3d;
using Eigen::Vector3d;

RigidTransform SixAxisLoop::turn(std::size_t axis, double angle) const {
  const Matrix3d rotation = rotation_about(direction[axis], angle);
  return {rotation, point[axis] - rotation * point[axis]};
}

RigidTransform SixAxisLoop::turns(std::size_t first, std::size_t count, const LoopAngles& angles) const {
  RigidTransform product;
  for (std::size_t i = first; i < first + count; ++i) product = product * turn(i, angles[i]);
  return product;
}

SixAxisLoop SixAxisLoop::begun_at(std::size_t first) const {
  SixAxisLoop shifted;
  shifted.target = target;
  const RigidTransform back = target.inverse();
  for (std::size_t i = 0; i < kLoopAxes; ++i) {
    const std::size_t from = (i + first) % kLoopAxes;
    const bool passed = from < first;
    shifted.direction[i] = passed ? Vector3d(back.rotation * direction[from]) : direction[from];
    shifted.point[i] = passed ? back * point[from] : point[from];
  }
  return shifted;
}

LoopAngles SixAxisLoop::in_first_order(const LoopAngles& angles, std::size_t first) {
  LoopAngles ordered{};
  for (std::size_t i = 0; i < kLoopAxes; ++i) ordered[(i + first) % kLoopAxes] = angles[i];
  return ordered;
}

double SixAxisLoop::size() const {
  double largest = 0;
  for (std::size_t i = 0; i < kLoopAxes; ++i) {
    for (std::size_t k = 0; k < i; ++k) largest = std::max(largest, (point[i] - point[k]).norm());
  }
  return std::max(largest, 1e-9);
}

LoopVector missing_of(const SixAxisLoop& loop, const LoopAngles& angles, const Vector3d& at, double length,
                      LoopMatrix* jacobian) {
  RigidTransform reached;
  std::array<Vector3d, kLoopAxes> direction, point;
  for (std::size_t i = 0; i < kLoopAxes; ++i) {
    direction[i] = reached.rotation * loop.direction[i];
    point[i] = reached * loop.point[i];
    reached = reached * loop.turn(i, angles[i]);
  }
  const Vector3d there = reached * at;
  LoopVector missing;
  missing.head<3>() = (loop.target * at - there) / length;
  missing.tail<3>() = rotation_vector(loop.target.rotation * reached.rotation.transpose());
  if (jacobian == nullptr) return missing;
  for (std::size_t i = 0; i < kLoopAxes; ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    jacobian->col(column).head<3>() = direction[i].cross(there - point[i]) / length;
    jacobian->col(column).tail<3>() = direction[i];
  }
  return missing;
}

double polish(const SixAxisLoop& loop, const Vector3d& at, double length, LoopAngles& angles) {
  constexpr int kMost = 30;
  constexpr double kRounding = 1e-14;
  constexpr double kLongestStep = 0.5;  // rad
  LoopMatrix jacobian;
  LoopVector missing = missing_of(loop, angles, at, length, &jacobian);
  double norm = missing.norm();
  for (int i = 0; i < kMost && norm > kRounding; ++i) {
    LoopVector step = FullLu<6>(jacobian).solve(missing);
    const double longest = step.cwiseAbs().maxCoeff();
    if (!std::isfinite(longest)) break;
    double part = longest > kLongestStep ? kLongestStep / longest : 1;
    LoopAngles next{};
    LoopMatrix next_jacobian;
    LoopVector next_missing;
    bool better = false;
    for (int cut = 0; cut < 4 && !better; ++cut, part *= 0.25) {
      for (std::size_t k = 0; k < kLoopAxes; ++k) next[k] = angles[k] + part * step[static_cast<Eigen::Index>(k)];
      next_missing = missing_of(loop, next, at, length, &next_jacobian);
      better = next_missing.norm() < norm;
    }
    if (!better) break;
    angles = next;
    missing = next_missing;
    jacobian = next_jacobian;
    norm = missing.norm();
  }
  return norm;
}

void approach(const SixAxisLoop& loop, const Vector3d& at, double length, LoopAngles& angles) {
  constexpr int kMost = 200;
  constexpr double kStanding = 1e-12;      // rad
  constexpr double kLongestPart = 0.3;     // rad
  constexpr double kOrientationPart = 10;  // a turn by 1 rad moves the point by less than this, in units of the size
  const auto merit = [](const LoopVector& m) { return m.head<3>().norm() + kOrientationPart * m.tail<3>().norm(); };
  LoopMatrix jacobian;
  LoopVector missing = missing_of(loop, angles, at, length, &jacobian);
  double damping = 1e-3;
  for (int i = 0; i < kMost; ++i) {
    const Eigen::Matrix<double, 3, 6> by_position = jacobian.topRows<3>(), by_turn = jacobian.bottomRows<3>();
    // The turn is made up exactly, or nearly where it cannot be; what is left free of it serves the position.
    const Matrix3d square = by_turn * by_turn.transpose() + 1e-14 * Matrix3d::Identity();
    const Eigen::Matrix<double, 6, 3> back = by_turn.transpose() * square.inverse();
    const LoopVector turn = back * missing.tail<3>();
    const LoopMatrix free = LoopMatrix::Identity() - back * by_turn;
    const Eigen::Matrix<double, 3, 6> by_free = by_position * free;
    const LoopMatrix normal = by_free.transpose() * by_free + damping * LoopMatrix::Identity();
    const LoopVector serve =
        free * FullLu<6>(normal).solve(by_free.transpose() * (missing.head<3>() - by_position * turn));
    const double longest = std::max(turn.cwiseAbs().maxCoeff(), serve.cwiseAbs().maxCoeff());
    if (!std::isfinite(longest)) return;
    LoopAngles next = angles;
    for (const LoopVector& part : {turn, serve}) {
      const double scale = std::min(1.0, kLongestPart / std::max(part.cwiseAbs().maxCoeff(), kLongestPart));
      for (std::size_t k = 0; k < kLoopAxes; ++k) next[k] += scale * part[static_cast<Eigen::Index>(k)];
    }
    LoopMatrix next_jacobian;
    const LoopVector next_missing = missing_of(loop, next, at, length, &next_jacobian);
    if (merit(next_missing) < merit(missing)) {
      angles = next;
      missing = next_missing;
      jacobian = next_jacobian;
      damping = std::max(damping * 0.3, 1e-12);
    } else {
      damping *= 10;
      if (damping > 1e6) return;
    }
    if (longest < kStanding) return;
  }
}

LoopCandidates solve_loop(const SixAxisLoop& loop, const Vector3d& at, const LoopAngles& start, double tolerance,
                          std::size_t distinct) {
  constexpr double kExact = 1e-9;   // a departure below it is rounding
  constexpr double kNearly = 2e-2;  // up to it, the solutions lie near those of the special geometry
  constexpr double kSame = 1e-7;    // rad
  const double departure = departure_from_decoupled(loop), size = loop.size();
  LoopCandidates candidates;
  if (departure <= kNearly) add_decoupled_candidates(loop, start, candidates);
  if (departure > kExact) add_general_candidates(loop, candidates);
  LoopCandidates solutions;
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    LoopCandidate candidate = candidates[k];
    if (!(polish(loop, at, size, candidate.angle) <= tolerance)) continue;
    if (departure > kExact) candidate.free_axis = kLoopAxes;
    bool known = false;
    for (std::size_t s = 0; s < solutions.size() && !known; ++s) {
      known = true;
      for (std::size_t i = 0; i < distinct; ++i) {
        const double apart = std::remainder(solutions[s].angle[i] - candidate.angle[i], 2 * std::numbers::pi);
        known = known && std::abs(apart) < kSame;
      }
    }
    if (!known) solutions.add(candidate);
  }
  return solutions;
}

}  // namespace abbe
