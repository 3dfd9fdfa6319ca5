#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "abbe/compensate/axis_directions.h"
#include "abbe/compensate/compensated_inverse.h"
#include "abbe/compensate/program/program_move.h"

namespace abbe {

/// Place in a program where a figure is largest.
struct ProgramPlace {
  double value = 0;                          ///< mm or rad; of the figure
  std::size_t line = 0;                      ///< of the program; 0: nowhere
  std::array<double, kMaxAxes> position{};   ///< commands as programmed, chain order; mm or rad
  std::array<double, kMaxAxes> corrected{};  ///< commands that reach the same with the errors
  std::array<double, 3> tool_length{};       ///< mm, in force there
  CorrectionStatus status = CorrectionStatus::not_run;
  AxisApproach approach{};  ///< directions of the last motions, of axes whose directions are followed

  bool take(const ProgramPlace& other);  ///< keeps the larger; the earlier of equal ones
};

/// How many poses (ends of moves and pieces) got a status, and the first lines where.
struct StatusCount {
  static constexpr std::size_t kLines = 5;
  std::size_t count = 0;
  std::array<std::size_t, kLines> line{};  ///< the first lines, different ones; 0: none

  void add(std::size_t at_line);
  void add(const StatusCount& later);
};

/// Result of the correction of a program.
struct ProgramReport {
  std::size_t moves = 0;
  std::size_t pieces = 0;
  std::size_t split_moves = 0;
  ProgramPlace largest_shift;                  ///< of the functional point by the correction, mm
  std::array<ProgramPlace, kMaxAxes> by_axis;  ///< |corrected - programmed|, mm or rad
  ProgramPlace largest_orientation_left;       ///< rad, of the tool direction, where the machine cannot turn it
  std::array<StatusCount, kCorrectionStatuses> status;        ///< by CorrectionStatus, of the ends of moves and pieces
  std::array<ProgramPlace, kCorrectionStatuses> first_place;  ///< of each status; mm, by which the point is missed
  /// Ends of rapid moves within the travel whose correction would lead out of it and was held at its end; not counted
  /// in `status`.
  StatusCount held_at_travel;
  ProgramPlace largest_held;  ///< mm, by which the actual point misses that place
  /// Feed moves that begin where a rapid move was held at the end of a travel. From the place where the point is
  /// reached, they are proven like all others.
  StatusCount held_starts;
  ProgramPlace largest_held_start;  ///< mm, by which the actual point misses their beginning
  StatusCount bent_with_spindle;    ///< moves with the spindle, which are not split, whose path leaves the tolerance
  ProgramPlace largest_bend;        ///< mm, by the bound of their paths
  StatusCount play_with_spindle;    ///< moves with the spindle in which axes with reversal values turn round
  StatusCount not_proven;           ///< moves whose path could not be shown to stay within the tolerance
  StatusCount tool_changes;         ///< moves that begin where the machine stood with another tool length
  StatusCount inverse_time;         ///< moves per minute with pieces whose duration needs inverse time
  StatusCount above_limit;          ///< ends where the point's correction is above the limit
  std::array<StatusCount, kMaxAxes> take_ups;  ///< of axes whose directions are followed, where they turn round
  std::array<StatusCount, kMaxAxes> direction_unknown;  ///< poses before the axis has moved
  /// Words that move an axis that the machine does not have, or tool centre moves it cannot make.
  StatusCount impossible;

  void add(const ProgramReport& later);
};

}  // namespace abbe
