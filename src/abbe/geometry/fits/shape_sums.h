#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "abbe/geometry/fits/shape_frame.h"

/// Inside of the fits: passes over all points, vectorised and on several threads.
namespace abbe::fits {

inline constexpr std::size_t kBlockPoints = 4096;
/// Products of at most 6 slopes and a residual.
inline constexpr std::size_t kProducts = 28;

/// Normal equations of a fit at a frame, over all steps; those that a kind does not have are zero.
struct NormalSums {
  Eigen::Matrix<double, kParameters, kParameters> matrix;  ///< sum of w J'J
  Step gradient;                                           ///< sum of w J'd
  double squares = 0;                                      ///< sum of w d^2, mm^2
};

/// @param weights  [n] or empty
NormalSums normal_sums(const ShapeFrame& frame, const FitPoints& points, std::span<const double> weights, int threads);

/// Distances of all points as distance() of shapes.h gives them, mm. @param out [n]
void distances(const ShapeFrame& frame, const FitPoints& points, std::span<double> out, int threads);

/// Smallest and largest distance, the first of equal ones.
struct ExtremeDistances {
  double smallest = 0, largest = 0;
  std::size_t smallest_at = 0, largest_at = 0;
};
ExtremeDistances extreme_distances(const ShapeFrame& frame, const FitPoints& points, int threads);

/// Centroid from `centre`, mm, and whether every coordinate is finite.
struct Centroid {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();  ///< mean of (q - mean)(q - mean)', mm^2
  bool finite = true;
};
Centroid centroid(const FitPoints& points, const Eigen::Vector3d& centre, int threads);

/// The frame as the vectorised functions take it.
struct KernelFrame {
  ShapeKind kind = ShapeKind::plane;
  double centre[3], axes[3][3], origin[3];  ///< axes[k]: e_k; origin along the axes
  double radius, sine, cosine;
};

}  // namespace abbe::fits
