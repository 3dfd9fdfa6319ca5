#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "abbe/compensate/axis_error_bound.h"
#include "abbe/compensate/program/factor_bounds.h"
#include "abbe/errors/error_set.h"
#include "abbe/machine/machine.h"

namespace abbe {

struct ErrorAlong;

/// Distances of the functional point from the point and line of each axis of the nominal chain; mm.
struct ChainLevers {
  std::array<double, kMaxAxes> from_point{};  ///< from Axis::point
  std::array<double, kMaxAxes> from_line{};   ///< rotary: from the axis line
  double tool_error = 0;                      ///< of the functional point, by the length of the tool
};

/// Bounds of how the axes move over one piece of a path, over 0 <= s <= 1, or over several pieces at once (the largest
/// of each). Commanded: by the program; actual: as the control drives for the corrected one. mm and rad; rates by s.
struct PieceMotion {
  std::array<double, kMaxAxes> lowest{}, highest{};       ///< actual commands
  std::array<double, kMaxAxes> width{};                   ///< how far the commands are from those of the levers
  std::array<double, kMaxAxes> speed{}, actual_speed{};   ///< |rate| of the commands, commanded and actual
  std::array<double, kMaxAxes> offset{}, offset_speed{};  ///< |actual - commanded| and of its rate
  double arc_bend = 0;  ///< |second derivative| of the commanded X, Y, Z, as a vector: of arcs

  // Tool centre programs; X, Y, Z are a straight line of the functional point then.
  bool tool_centre = false;
  double point_speed = 0;  ///< |rate| of the actual X, Y, Z
  double point_width = 0;  ///< how far they are from the point of the levers, mm
};

/// By how much the tool leaves the commanded path between the ends of a piece, beyond the error at the ends.
struct PieceBound {
  double position = 0;     ///< mm
  double orientation = 0;  ///< rad, of the tool's direction

  // In addition, for axes with reversal values (docs/programs.md, "Reversal"):
  double lag = 0;        ///< mm; by how much the point is off while axes may lag by PieceMotion's dead bands
  double lag_turn = 0;   ///< rad; the same for the tool's direction
  double axis_bend = 0;  ///< tool centre: |second derivative by s| of the commands of X, Y, Z; mm
};

/// Axes with play: their commands are offset by up to half of the reversal value in either direction.
struct PlayBounds {
  std::array<double, kMaxAxes> offset{};  ///< of commands, mm or rad
  std::array<double, kMaxAxes> lag{};     ///< of the actual position behind that commanded, mm or rad; 0: no play
  bool any = false;
  bool lags_count = true;  ///< as part of the tolerance
};

/// Share of the dead band by which a linear axis may go beyond both ends of a piece in tool centre programs (where its
/// path is a curve).
inline constexpr double kOvershootShare = 0.25;

/// Proves that pieces stay near the commanded path: bounds |actual(s) - commanded(s)| using only bounds of the error
/// motions, their derivatives and levers.
///
/// With g the actual minus the commanded point, zero at both ends, |g| <= max|g''| / 8 + sum|jumps of g'| / 4. Bounds
/// of g and its derivatives are carried through the chain from the tool to the workpiece by the product rule.
/// Derivation: docs/programs.md. All operations are monotone: the bound of several pieces together (the largest of each
/// entry) is a bound of each. Thread-safe.
class PieceBounder {
 public:
  /// @param machine     sound
  /// @param point_axes  those of X, Y, Z, which arcs move and which follow from the point in tool centre programs;
  ///                    Machine::npos: none
  PieceBounder(const Machine& machine, const ErrorSet& errors, const std::array<std::size_t, 3>& point_axes);

  /// Reversal values: the constructor does not take them from the errors.
  void set_play(const PlayBounds& play) { play_ = play; }
  const PlayBounds& play() const { return play_; }
  /// As in ProgramCorrectionOptions.
  void set_tool_length_share(double share) { tool_length_share_ = share; }
  bool is_point_axis(std::size_t i) const { return i == point_axes_[0] || i == point_axes_[1] || i == point_axes_[2]; }

  /// False if a rotary axis stands between X, Y and Z, or if they are dependent: no bound for tool centre programs.
  bool has_tool_centre() const { return has_point_axes_; }

  /// @param levers  at a pose of the piece
  /// @param motion  its entries are those of chords; those of X, Y, Z are widened for arcs and tool centre programs
  PieceBound bound(const ChainLevers& levers, PieceMotion& motion) const;

  /// Levers of the nominal machine.
  /// @param tool  functional point from the gauge point, mm
  void levers(const double* positions, const Eigen::Vector3d& tool, ChainLevers& result) const;

 private:
  /// Location errors of an axis: what they do to its line, per unit of the factor of their state.
  struct LineError {
    double turn = 0;           ///< rad, of the axis direction
    double shift = 0;          ///< mm, of its place
    double zero_position = 0;  ///< mm or rad
  };
  struct StateErrors {
    std::size_t state;
    AxisErrorCells motions;
    LineError line;
  };
  struct AxisModel {
    AxisModel(const Machine& machine, const ErrorSet& error_set, std::size_t axis)
        : rotary(machine.axes[axis].kind == AxisKind::rotary),
          tool_side(machine.axes[axis].side == ChainSide::tool),
          errors(machine, error_set, axis) {}
    bool rotary, tool_side;
    AxisErrorCells errors;
    LineError line;
    std::vector<StateErrors> with_state;
    bool run_begins = false;  ///< first linear axis, from the tool, of those with no rotary one between
    std::vector<std::size_t> run;
    double run_stretch = 1;  ///< largest singular value of the run's directions
    bool bends = false;      ///< X, Y or Z belongs to this run
  };
  struct Stage {
    double speed = 0, bend = 0;
  };
  /// The line of an axis along a piece, all states together; as LineError.
  struct LineAlong {
    BoundAlong turn, shift, zero_position;
  };
  struct Passing;
  static LineError line_error(const Machine& machine, const ErrorSet& errors, std::size_t axis, std::size_t state);
  void add_states(const Machine& machine, const ErrorSet& errors);
  LineAlong line_along(const AxisModel& axis, const Passing& at) const;
  ErrorAlong error_along(std::size_t i, double bend, Passing& at, double length) const;
  void set_states(Passing& at) const;
  double own_bend_of(std::size_t i, const Passing& at) const;
  void pass_run(const AxisModel& axis, Passing& at) const;
  void pass_rotary(std::size_t i, Passing& at) const;
  void pass_linear(std::size_t i, Passing& at) const;
  void set_point_axes();
  double move_point_axes(const ChainLevers& levers, PieceMotion& motion, std::array<Stage, kMaxAxes>& stages) const;
  void follow_arc(PieceMotion& motion) const;
  void widen_by_play(const ChainLevers& levers, PieceMotion& motion) const;

  Machine machine_;
  std::vector<AxisModel> axes_;
  FactorBounds factors_;
  PlayBounds play_;
  double tool_error_ = 0, tool_length_share_ = 0;
  std::array<std::size_t, 3> point_axes_;  ///< chain order
  bool has_point_axes_ = false;
  double point_condition_ = 1;  ///< 1 / smallest singular value of the point axes' directions
};

}  // namespace abbe
