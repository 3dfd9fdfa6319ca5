#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "abbe/verify/evaluations/statistics.h"

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
    std::size_t before = 0;          ///< the point of the curve before this place
    double share = 0;                ///< 0 .. 1, of the way from there to the next point
  };
  Foot nearest(const Eigen::Vector3d& point) const;

  /// Points that it goes through: as given.
  Eigen::Index size() const { return size_; }
  bool closed() const { return closed_; }
  double length() const { return along_.back(); }
  /// Length of the curve up to the points. [n], closed: [n + 1]
  const std::vector<double>& along() const { return along_; }

 private:
  Eigen::Vector3d at(std::size_t i, double t, Eigen::Vector3d* first, Eigen::Vector3d* second) const;
  double arc(std::size_t i, double to) const;

  Eigen::Index size_ = 0;
  bool closed_ = false;
  std::vector<Eigen::Vector3d> points_;            // closed: with the first again behind the last
  std::vector<Eigen::Vector3d> leaving_, coming_;  // [pieces] derivatives by t = 0 .. 1 at both ends of a piece
  std::vector<double> along_;
};

/// A piece of a commanded curve, and the surface on which it lies.
struct CommandPiece {
  CommandCurve curve;
  Eigen::Matrix3Xd normals;  ///< [3, curve.size()] out of the surface at the curve's points, of any length; or none
};

/// Contour error at one measured point: its distance from the commanded curve.
struct ContourDeviation {
  std::size_t piece = 0;         ///< the nearest one
  double along = 0;              ///< mm, where on the curve: pieces are counted one behind the other
  double distance = 0;           ///< mm
  bool beyond_end = false;       ///< of that piece
  std::optional<double> across;  ///< mm, in the surface, positive to the left of the curve seen from outside
  std::optional<double> off;     ///< mm, out of the surface
};

/// Deviations of measured points from a commanded curve, each from the piece nearest to it.
///
/// Between the curve's points its normal turns evenly from one to the other. Where there is no normal, or it points
/// along the curve, nothing is across: only the distance is known.
/// @param pieces  one at least
/// @param points  [3, n] mm
/// @throws std::invalid_argument without a piece, and for normals that are not as many as the points of their curve
std::vector<ContourDeviation> contour_deviations(std::span<const CommandPiece> pieces, const Eigen::Matrix3Xd& points);

/// Mean, largest and standard deviation of amounts, and the signed mean, with the uncertainty that the points' own
/// give.
struct ContourFigures {
  SampleStatistics amounts;                                                         ///< mm
  double mean_uncertainty = 0, largest_uncertainty = 0, deviation_uncertainty = 0;  ///< standard, mm
  double bias = 0, bias_uncertainty = 0;                                            ///< mm, mean of the signed errors
};

/// Of signed errors: the figures are those of their amounts, as papers state them, and the bias.
///
/// Noise does not average out of an amount: |e + noise| is larger than |e| in the mean. The uncertainty of each figure
/// is to first order where errors are larger than their uncertainties, else not smaller than it is there.
/// @param uncertainties  [errors] standard, independent of each other; or none
/// @param common         standard uncertainty that all errors share (where the section's origin is), mm
ContourFigures contour_figures(std::span<const double> errors, std::span<const double> uncertainties = {},
                               double common = 0);

}  // namespace abbe
