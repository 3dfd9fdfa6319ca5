#pragma once

// Internal to plan: matrices of the few rows of one candidate.
#include <array>
#include <cmath>
#include <cstddef>

#include "abbe/plan/readings/planning_space.h"

namespace abbe::planning {

using Small = std::array<double, PlanningCandidates::kMostRows * PlanningCandidates::kMostRows>;
// Below this the rest of a choice does not determine everything, and a pivot is rounding.
inline constexpr double kSmallestPivot = 1e-9;

/// Lower factor of I + sign W, [n, n] row by row with row length n. False if it is not positive definite.
inline bool factorise(const double* w, std::size_t n, double sign, Small& lower) {
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j <= i; ++j) {
      double sum = (i == j ? 1.0 : 0.0) + sign * w[i * n + j];
      for (std::size_t k = 0; k < j; ++k) sum -= lower[i * n + k] * lower[j * n + k];
      if (i == j) {
        if (!(sum > kSmallestPivot)) return false;
        lower[i * n + i] = std::sqrt(sum);
      } else {
        lower[i * n + j] = sum / lower[j * n + j];
      }
    }
  return true;
}

inline double log_determinant(const Small& lower, std::size_t n) {
  double product = 1;
  for (std::size_t i = 0; i < n; ++i) product *= lower[i * n + i];
  return 2 * std::log(product);
}

/// trace((L L')^-1 G)
inline double trace_of_quotient(const Small& lower, const double* g, std::size_t n) {
  Small half;  // L^-1 G
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t c = 0; c < n; ++c) {
      double sum = g[i * n + c];
      for (std::size_t k = 0; k < i; ++k) sum -= lower[i * n + k] * half[k * n + c];
      half[i * n + c] = sum / lower[i * n + i];
    }
  double trace = 0;
  for (std::size_t row = 0; row < n; ++row) {  // diagonal of (L^-1 G) L^-T: solve for one row as far as its diagonal
    std::array<double, PlanningCandidates::kMostRows> solved{};
    for (std::size_t i = 0; i <= row; ++i) {
      double sum = half[row * n + i];
      for (std::size_t k = 0; k < i; ++k) sum -= lower[i * n + k] * solved[k];
      solved[i] = sum / lower[i * n + i];
    }
    trace += solved[row];
  }
  return trace;
}

}  // namespace abbe::planning
