#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "abbe/instruments/equation_instrument.h"
#include "abbe/instruments/setup_orientation.h"

namespace abbe {

/// Marks that a focused beam engraves in flat boards, read afterwards with a microscope.
struct BoardMarksSetup {
  enum class Position {
    none,   ///< only widths are read
    point,  ///< both coordinates of a point in the board
    line    ///< the coordinate of a line across its own direction
  };
  struct Board {
    std::string name = "board1";
    SetupPoint position;  ///< mm, origin of the board's coordinates, in its engraved surface; frame of board_body
    SetupPoint angles;    ///< rad, a, b, c of Rz(c) Ry(b) Rx(a): the board's u, v, w in the frame of board_body
  };
  std::string name = "marks1";
  Position position = Position::point;
  bool width = false;  ///< widths are read too
  Body beam_body = Body::tool;
  SetupPoint focus;                                 ///< mm, frame of beam_body; tool: from the gauge point
  Eigen::Vector3d beam = Eigen::Vector3d::UnitZ();  ///< from the focus to the source, frame of beam_body; any length
  SetupNumber beam_tilt_first, beam_tilt_second;    ///< rad, see DirectionFrame
  Body board_body = Body::workpiece;
  std::vector<Board> boards;                          ///< at least one
  SetupNumber waist = SetupNumber::exact(0.03);       ///< mm, width of a line at the focus
  SetupNumber divergence = SetupNumber::exact(0.05);  ///< width per distance from the focus, far from it; tangent
  double position_noise = 2e-3;                       ///< mm, standard uncertainty of a coordinate
  double width_noise = 2e-3;                          ///< mm, of a width
};

/// Where marks are on a board, and how wide they are.
///
/// With (R, t) the beam's body seen from the board's body, focus F = R f + t and beam D = R d, the board through P with
/// axes u, v, w (w out of the engraved surface), the beam meets the board at
///
///     M = F + s D,  s = w . (P - F) / (w . D)       s: distance from the focus to the board along the beam
///
///     point   reading u = u . (M - P), v = v . (M - P)
///     line    reading position = cos(phi) u + sin(phi) v with the input `direction` phi: the direction in the board
///             along which the line's position is read (0: along u), that is across the line
///     width   reading width = sqrt(waist^2 + divergence^2 s^2)
///
/// so width squared is a parabola of the distance and its lowest point the focus. (Yin takes the thinnest of the lines,
/// which costs 88 um where the parabola costs 7.) A mark in focus is the focus itself. A board seen by marks alone
/// holds no position of its own: cannot be told apart are the board's shift and turn from those of the table, its
/// height from the length of the head unless the head is turned (A = +-90 degrees) or the height is known, and the zero
/// of A from a shift of the focus across the beam together with its length (1.17 um per arcsec on Yin's machine). The
/// sign of s is not seen by one width. The waist is uncertain where all widths are far from the focus. Items: the
/// boards. Components: u, v or position, then width (mm). Inputs: direction (rad) for lines. Source: Yin et al.,
/// Machines 9 (2021) 237, section 3.1; the corrected equations are in docs/board-marks.md.
class BoardMarks : public EquationInstrument<BoardMarks, 13, 3> {
 public:
  /// @throws std::invalid_argument no board, nothing to read, a waist below zero
  explicit BoardMarks(const BoardMarksSetup& setup);

  double standard_uncertainty(const InstrumentReadings& readings, std::size_t reading,
                              std::size_t component) const override;
  /// The focus and the origin of the board.
  std::optional<MeetingPoints> meeting_points(std::size_t item) const override;
  /// The beam and the boards.
  std::vector<InstrumentPlace> places() const override;
  PoseFreedom pose_freedom() const override { return PoseFreedom::together; }
  /// Lines: one read along u and one along v.
  std::vector<std::vector<double>> planned_inputs(std::size_t item) const override;

  template <typename S>
  void equation(std::size_t, const SeenBody<S>& seen, const S* quantities, const double* inputs, S* reading) const;

 private:
  BoardMarksSetup::Position position_;
  bool width_;
  DirectionFrame beam_;
  double position_noise_, width_noise_;
};

}  // namespace abbe
