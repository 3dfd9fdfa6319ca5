#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "abbe/geometry/rigid_transform.h"

namespace abbe {

/// What a best fit can say about its own geometry.
enum class BestFitStatus {
  not_run,
  ok,
  too_few_points,  ///< fewer than three points with weight
  coincident,      ///< all points at one place: only the translation is determined
  collinear,       ///< all points on one line: the rotation about it is not determined
  no_consensus     ///< robust fit: no transform brings half of the points together
};
const char* best_fit_status_name(BestFitStatus status);

/// Rigid motion that brings one set of points onto another.
struct BestFitTransform {
  BestFitStatus status = BestFitStatus::not_run;
  RigidTransform target_from_source;  ///< for coincident and collinear points: one of the many that fit equally well
  double rms = 0;                     ///< weighted root mean square distance target - transform * source, mm
  /// Root mean square extent of the source points along their principal directions, largest first, mm.
  Eigen::Vector3d extent = Eigen::Vector3d::Zero();
  /// Collinear: unit direction, in the target frame, about which the rotation is not determined; its largest
  /// component is positive.
  Eigen::Vector3d undetermined_direction = Eigen::Vector3d::Zero();
  double scale = 0;                   ///< robust fit: robust standard deviation of one coordinate, mm
  std::vector<std::uint8_t> inliers;  ///< robust fit: [points], 1 where the point took part in the last step
};

/// Root mean square distance of points from their mean, mm; 0 without points.
double extent_of_points(std::span<const Eigen::Vector3d> points);

/// Rotation R that makes the trace of R^T * correlation largest, correlation = sum of target * source^T (centred).
Eigen::Matrix3d rotation_from_correlation(const Eigen::Matrix3d& correlation);

/// Weighted least-squares rigid transform between paired points, no reflection, no scale.
///
/// @param source            [n] points, mm
/// @param target            [n] their partners, mm
/// @param weights           [n] >= 0, or empty for equal weights
/// @param collinear_extent  points whose second extent is not larger than this count as collinear, mm; at least 1e-9 of
///                          the first extent is always taken
/// Source: Kabsch, Acta Cryst. A32 (1976) 922; Umeyama, IEEE PAMI 13 (1991) 376 (sign of the determinant).
BestFitTransform best_fit_transform(std::span<const Eigen::Vector3d> source, std::span<const Eigen::Vector3d> target,
                                    std::span<const double> weights = {}, double collinear_extent = 0);

struct RobustFitOptions {
  int trials = 400;             ///< triples tried; 400 miss all-good triples at 40 % outliers with probability 4e-43
  std::size_t scored = 2000;    ///< points used to score a triple (evenly spread over the data)
  std::uint64_t seed = 1;       ///< same seed, same answer
  double collinear_extent = 0;  ///< as best_fit_transform()
};

/// As best_fit_transform(), but for data of which up to 40 % may be wrong.
///
/// Triples drawn at random (seeded) are scored by the 55 % quantile of the distances (least quantile of squares); the
/// best is refined by iteratively reweighted least squares with Tukey's biweight at a scale from the median distance.
/// Source: Fischler and Bolles, Comm. ACM 24 (1981) 381; Rousseeuw, J. Am. Stat. Assoc. 79 (1984) 871.
BestFitTransform robust_best_fit_transform(std::span<const Eigen::Vector3d> source,
                                           std::span<const Eigen::Vector3d> target,
                                           const RobustFitOptions& options = {});

}  // namespace abbe
