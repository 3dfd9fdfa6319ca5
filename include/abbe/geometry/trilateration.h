#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace abbe {

enum class TrilaterationStatus {
  not_run,
  ok,
  mirrored,        ///< the points lie in a plane: the position mirrored at it explains the lengths as well
  collinear,       ///< the points lie on a line: every position on a circle about it does
  too_few_points,  ///< fewer than unknowns
  no_consensus     ///< no position explains half of the lengths
};

/// Lengths from one unknown point to known points, in runs with a dead path each.
struct TrilaterationData {
  std::vector<Eigen::Vector3d> points;           ///< [n] mm
  std::vector<double> lengths;                   ///< [n] indicated: distance minus dead path of the run, mm
  std::vector<std::size_t> run;                  ///< [n] index into dead_path
  std::vector<std::optional<double>> dead_path;  ///< [runs] mm; nothing: unknown
  std::optional<Eigen::Vector3d> near;           ///< rough guess, decides between mirrored positions; mm
};

struct TrilaterationOptions {
  double tolerance = 5;  ///< mm: more than half of the lengths, (n + unknowns) / 2, have to be explained within it
  std::size_t draws = 200;
};

struct Trilateration {
  TrilaterationStatus status = TrilaterationStatus::not_run;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();   ///< mm; ok and mirrored: meaningful; else `near` or zero
  Eigen::Vector3d other = Eigen::Vector3d::Zero();      ///< mirrored: the position that was not taken, mm
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();  ///< unit; mirrored: normal of the plane, collinear: the line
  std::vector<double> dead_path;                        ///< [runs] mm
  std::vector<std::uint8_t> inliers;                    ///< [n] 0: took no part
  double rms = 0;                                       ///< of the lengths that took part, mm
};

/// Position and dead paths from lengths to known points, robust against up to 40 % wrong lengths.
///
/// From |x - p|^2 = (l + d)^2 every length gives  2 x . p + 2 l d + (d^2 - |p|^2) = |x|^2 - l^2,  linear in p, d and
/// the bracket. Random subsets of one run are solved that way, in space and, with the normal part of p from the
/// bracket, in the best plane through the points; the best by the residual of the (n + unknowns) / 2-th length are
/// refined by Gauss-Newton with Tukey's weights. The refined position mirrored at the plane is refined too: a unique
/// answer has to explain the lengths better.
/// @throws std::invalid_argument if sizes do not agree
Trilateration trilaterate(const TrilaterationData& data, const TrilaterationOptions& options = {});

/// Dead paths for a given position: known ones, else the median over the run. @return [runs] mm
std::vector<double> dead_paths_at(const TrilaterationData& data, const Eigen::Vector3d& position);

}  // namespace abbe
