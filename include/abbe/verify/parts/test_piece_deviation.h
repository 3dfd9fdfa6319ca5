#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "abbe/machine/test_piece.h"
#include "abbe/verify/parts/actual_tool.h"
#include "abbe/verify/parts/small_motion.h"

namespace abbe {

enum class PieceTraceStatus {
  not_run,
  done,
  never_begins,  ///< no sample moves along the piece from where it begins; `row`: the nearest to its beginning
  leaves_piece,  ///< at `row` the tool is farther from its curve than the reach, before the end
  ends_early     ///< the samples end at `row` before the piece does
};

/// What a tool leaves on a test piece, sample by sample while it cuts, in the order of the cut. Lengths in mm.
struct PieceDeviation {
  PieceTraceStatus status = PieceTraceStatus::not_run;
  std::size_t row = 0;  ///< of the samples, where the status is not done
  double distance = 0;  ///< of that sample from the curve (never_begins: from its first point)
  double reached = 0;   ///< how far along the curve the cut goes
  double length = 0;    ///< of the whole curve

  std::vector<std::size_t> rows;              ///< [n] of the samples
  std::vector<double> along;                  ///< [n] place along the curve of the functional point, increasing
  std::vector<double> foot, head;             ///< [n] flank deviation, positive: material is left
  Eigen::Matrix3Xd contour;                   ///< [3, n] functional point from the nearest place of its curve
  Eigen::Matrix3Xd foot_point, head_point;    ///< [3, n] of the surface there
  Eigen::Matrix3Xd foot_normal, head_normal;  ///< [3, n] unit, out of the material
  Eigen::Matrix3Xd tool, tangent;             ///< [3, n] place on the curve of the functional point; unit along it
};

/// Finds for every sample the place on the piece that it cuts and what it leaves there.
///
/// The place is the nearest one of the curve of the functional point, looked for from the place before onwards and no
/// farther than the tool can have come, so that neither the second bow of an S nor the other end of a closed curve is
/// taken for it. Between two rulings the tool's point and direction, normals and length are interpolated linearly, so
/// points of the curve as dense as the figures are to be fine (ConeFrustum::chord_tolerance). A sample counts where the
/// tool moves along the curve, nearer to it than `reach`: not on the way to its first point, nor behind the last one,
/// nor at rest.
///
/// What the flank leaves at an end of a ruling is the displacement of the tool there along the normal: at the foot of
/// the functional point, at the head of the point of the tool's axis beside it, which a wrong direction displaces too.
/// @param actual  tool in the order of time, workpiece frame
/// @param reach   mm, larger than the errors of the machine and smaller than the way between the bows of the piece
PieceDeviation test_piece_deviation(const TestPiece& piece, const ToolPlaces& actual, double reach = 1);

/// One edge of the surface: the foot or the head of its rulings.
struct FlankFigures {
  double lowest = 0, highest = 0;  ///< mm
  double rms = 0;                  ///< about zero, evenly along the curve; mm
  double largest() const;          ///< magnitude
  double range() const { return highest - lowest; }
};

/// Distance of the functional point from its curve.
struct PieceContour {
  double mean = 0, largest = 0;  ///< mm, across the curve
};

struct PieceFigures {
  FlankFigures foot, head;
  PieceContour contour;
  SmallMotion datum;                         ///< taken out of foot and head
  std::vector<double> foot_left, head_left;  ///< [n] deviations that the figures are of, mm
};

/// Figures of a cut. The largest are those of all samples; fits and means weigh every length of the curve alike.
/// @param best_fit  take out the rigid displacement of the workpiece that explains most of it (least squares), as
///                  somebody who measures the piece aligns it: for foot and head together, for the contour alone
PieceFigures piece_figures(const PieceDeviation& deviation, bool best_fit);

/// Roundness of one section across the axis of a cone.
struct Roundness {
  bool evaluated = false;
  double roundness = 0;  ///< largest less smallest radius about the least-squares centre, mm
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  ///< mm, from the axis of the cone; +X, as the lean turns it, first
  double radius_deviation = 0;                       ///< mean radius less nominal, mm
};

/// Section of a cut cone at the height of the feet or of the heads of its rulings: a deviation d along the normal is
/// d / cos(half apex angle) of the radius there.
/// Source: ISO 10791-7:2020, M3 (roundness of the cone); ISO 12181-1 (least-squares reference circle).
Roundness cone_roundness(const ConeFrustum& frustum, const PieceDeviation& deviation, bool head);

}  // namespace abbe
