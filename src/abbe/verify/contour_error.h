#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "abbe/verify/statistics.h"

namespace abbe {

/// A commanded curve through points in space: cubic pieces between them, smooth except at corners.
///
/// The tangent at a point is that of the circle through it and its two neighbours; where the sides turn by more than
/// the corner's angle, and at the ends of an open curve, each piece has the tangent that its own side gives. Pieces
/// leave a circle of radius R by less than 2e-5 R turn^6: nothing for 4 mm on 500 mm, where chords are off by 4 um.
class CommandCurve {
 public:
  /// @param points  [3, n] mm, n >= 2; neighbours apart
  /// @param closed  the last point is followed by the first
  /// @param corner  rad
  /// @throws std::invalid_argument for fewer than two points or two in the same place, one behind the other
  explicit CommandCurve(const Eigen::Matrix3Xd& points, bool closed = false, double corner = 0.35);

  /// The nearest place of the curve.
  struct Foot {
    Eigen::Vector3d point, tangent;  ///< mm; unit, in the curve's sense
    double along = 0;                ///< mm, length of the curve up to here
    double distance = 0;             ///< mm
    bool beyond_end = false;         ///< the curve ends here, and the measured point lies beyond
  };
  Foot nearest(const Eigen::Vector3d& point) const;

  double length() const { return along_.back(); }
  /// Length of the curve up to the points. [n], closed: [n + 1]
  const std::vector<double>& along() const { return along_; }

 private:
  Eigen::Vector3d at(std::size_t i, double t, Eigen::Vector3d* first, Eigen::Vector3d* second) const;
  double arc(std::size_t i, double to) const;

  std::vector<Eigen::Vector3d> points_;            // closed: with the first again behind the last
  std::vector<Eigen::Vector3d> leaving_, coming_;  // [pieces] derivatives by t = 0 .. 1 at both ends of a piece
  std::vector<double> along_;
};

/// Contour error at one measured point: its distance from the commanded curve.
struct ContourDeviation {
  double along = 0;     ///< mm, where on the curve
  double across = 0;    ///< mm, in the surface, positive to the left of the curve seen from outside; without a normal 0
  double off = 0;       ///< mm, out of the surface; without a normal 0
  double distance = 0;  ///< mm
  bool beyond_end = false;
};

/// Deviations of measured points from a commanded curve.
/// @param points   [3, n] mm
/// @param normals  [3, n] out of the surface at those points, or none: only distances
std::vector<ContourDeviation> contour_deviations(const CommandCurve& curve, const Eigen::Matrix3Xd& points,
                                                 const Eigen::Matrix3Xd& normals = {});

/// Mean, largest and standard deviation of amounts with the standard uncertainty that the points' own give the mean.
struct ContourFigures {
  SampleStatistics amounts;                                                         ///< mm
  double mean_uncertainty = 0, largest_uncertainty = 0, deviation_uncertainty = 0;  ///< standard, mm
};

/// Of signed errors: the figures are those of their amounts, as papers state them.
///
/// Noise does not average out of an amount: |e + noise| is larger than |e| in the mean. The uncertainty of each figure
/// is to first order where errors are larger than their uncertainties, else not smaller than it is there.
/// @param uncertainties  [errors] standard, independent of each other; or none
/// @param common         standard uncertainty that all errors share (where the section's origin is), mm
ContourFigures contour_figures(std::span<const double> errors, std::span<const double> uncertainties = {},
                               double common = 0);

}  // namespace abbe
