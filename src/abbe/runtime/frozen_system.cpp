#include "abbe/runtime/frozen_system.h"

#include <algorithm>
#include <cmath>

namespace abbe {
namespace {

/// Spread of singular values above which the plain solution keeps its digits (as in bounded_least_squares.cpp).
constexpr double kWellSpread = 1e-3;

double at(const Triple& a, std::size_t i) { return i == 0 ? a.x : i == 1 ? a.y : a.z; }

/// Eigenvalues and eigenvectors (columns of v) of a symmetric matrix by Jacobi's rotations.
void symmetric_eigen(double a[3][3], double v[3][3]) {
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) v[i][k] = i == k ? 1 : 0;
  }
  for (int sweep = 0; sweep < 12; ++sweep) {
    for (int p = 0; p < 2; ++p) {
      for (int q = p + 1; q < 3; ++q) {
        if (a[p][q] == 0) continue;
        const double theta = 0.5 * (a[q][q] - a[p][p]) / a[p][q];
        const double t = std::copysign(1 / (std::abs(theta) + std::hypot(1, theta)), theta);
        const double c = 1 / std::sqrt(1 + t * t), s = t * c;
        for (int k = 0; k < 3; ++k) {
          const double first = a[k][p], second = a[k][q];
          a[k][p] = c * first - s * second;
          a[k][q] = s * first + c * second;
        }
        for (int k = 0; k < 3; ++k) {
          const double first = a[p][k], second = a[q][k];
          a[p][k] = c * first - s * second;
          a[q][k] = s * first + c * second;
          const double one = v[k][p], other = v[k][q];
          v[k][p] = c * one - s * other;
          v[k][q] = s * one + c * other;
        }
        a[p][q] = a[q][p] = 0;
      }
    }
  }
}

}  // namespace

TurnSystem::TurnSystem(const abbe_runtime& machine, const NominalView& view)
    : count_(machine.turning.count), least_(machine.least_turning) {
  for (std::size_t i = 0; i < count_; ++i) {
    const Triple& w = view.column[machine.turning.axis[i]];
    across_[i] = w - dot(w, view.direction) * view.direction;
  }
  first_ = dot(across_[0], across_[0]);
  mixed_ = dot(across_[0], across_[1]);
  second_ = dot(across_[1], across_[1]);
  area_ = length(cross(across_[0], across_[1]));
  norm_ = std::sqrt(first_ + second_);
}

Triple TurnSystem::of(const std::array<double, 2>& y) const { return y[0] * across_[0] + y[1] * across_[1]; }

std::array<double, 2> TurnSystem::solve(const Triple& c, double largest, bool& bounded) const {
  bounded = false;
  if (count_ == 0) return {};
  const double t = std::max(length(c) / largest, least_);
  const double b0 = dot(across_[0], c), b1 = dot(across_[1], c);
  if (count_ == 2 && area_ > std::max(t, kWellSpread * norm_) * norm_) {
    const double by = 1 / (area_ * area_);
    return {by * (second_ * b0 - mixed_ * b1), by * (first_ * b1 - mixed_ * b0)};
  }
  const double middle = 0.5 * (first_ + second_), half = std::hypot(0.5 * (first_ - second_), mixed_);
  const double large = middle + half, small = large > 0 ? area_ * area_ / large : 0;
  bounded = large < t * t || (count_ == 2 && small < t * t);
  // Eigenvector of the larger value; of two ways to write it the one without cancellation.
  double x = large - second_, y = mixed_;
  if (first_ < second_) {
    x = mixed_;
    y = large - first_;
  }
  const double norm = std::hypot(x, y);
  if (norm > 0) {
    x /= norm;
    y /= norm;
  } else {
    x = 1;
    y = 0;
  }
  const double by_large = std::max(large, t * t), by_small = std::max(small, t * t);
  const double one = by_large > 0 ? (x * b0 + y * b1) / by_large : 0;
  const double other = count_ == 2 && by_small > 0 ? (x * b1 - y * b0) / by_small : 0;
  return {x * one - y * other, y * one + x * other};
}

ReachSystem::ReachSystem(const abbe_runtime& machine, const NominalView& view, const Triple& goal)
    : count_(machine.reaching.count), least_(machine.least_reaching) {
  for (std::size_t k = 0; k < count_; ++k) {
    const std::size_t i = machine.reaching.axis[k];
    column_[k] = machine.axis[i].rotary ? machine.reaching_unit[k] * cross(view.column[i], goal - view.origin[i])
                                        : view.column[i];
  }
  row_ = {cross(column_[1], column_[2]), cross(column_[2], column_[0]), cross(column_[0], column_[1])};
  determinant_ = dot(column_[0], row_[0]);
  const double all = dot(column_[0], column_[0]) + dot(column_[1], column_[1]) + dot(column_[2], column_[2]);
  square_ = 0.5 * all;
  norm_ = std::sqrt(all);
}

Triple ReachSystem::solve(const Triple& rest, double largest, bool& bounded) const {
  bounded = false;
  const double t = std::max(length(rest) / largest, least_);
  if (count_ == 3 && std::abs(determinant_) > std::max(t, kWellSpread * norm_) * square_) {
    return {dot(row_[0], rest) / determinant_, dot(row_[1], rest) / determinant_, dot(row_[2], rest) / determinant_};
  }
  return solve_generally(rest, t, bounded);
}

Triple ReachSystem::solve_generally(const Triple& rest, double bound, bool& bounded) const {
  if (count_ == 0) return {};
  double products[3][3], vectors[3][3];
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 3; ++k) products[i][k] = dot(column_[i], column_[k]);
  }
  symmetric_eigen(products, vectors);
  const Triple b{dot(column_[0], rest), dot(column_[1], rest), dot(column_[2], rest)};
  double z[3] = {};
  // With fewer axes the columns that are not there give eigenvalues 0 whose vectors no b has a part of.
  for (std::size_t i = 0; i < 3; ++i) {
    const double value = std::max(products[i][i], 0.0);
    double part = 0;
    for (std::size_t k = 0; k < count_; ++k) part += vectors[k][i] * at(b, k);
    const double divisor = std::max(value, bound * bound);
    if (divisor > 0) part /= divisor;
    for (std::size_t k = 0; k < count_; ++k) z[k] += vectors[k][i] * part;
    bool is_there = false;
    for (std::size_t k = 0; k < count_; ++k) is_there = is_there || std::abs(vectors[k][i]) > 0.5;
    if (is_there && value < bound * bound) bounded = true;
  }
  return {z[0], z[1], z[2]};
}

}  // namespace abbe
