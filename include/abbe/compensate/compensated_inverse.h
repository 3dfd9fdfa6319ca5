#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "abbe/errors/chain_plan.h"
#include "abbe/errors/error_set.h"
#include "abbe/machine/inverse_plan.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// What became of one pose.
enum class CorrectionStatus : std::uint8_t {
  not_run,
  reached,           ///< point, and orientation as far as it was asked for, within the tolerances
  orientation_left,  ///< the point is reached; no turn of the working rotary axes takes the orientation error away
  turn_limited,      ///< the point is reached; near a singularity the turn is bounded, a part of the orientation error
                     ///< stays
  position_left,     ///< the working axes do not reach the point, or only by too long a way
  outside_travel,    ///< a command would leave its travel and was kept at its end; the other axes take what they can
  not_covered,       ///< the errors are not known there (extrapolation): commands as they came, residuals NaN
  not_converged,     ///< commands as they came, residuals as they are there
  not_finite         ///< a command or the target is no number: commands as they came, residuals NaN
};
inline constexpr std::size_t kCorrectionStatuses = static_cast<std::size_t>(CorrectionStatus::not_finite) + 1;

/// The point is where it is wanted; the orientation as well as the machine can.
inline bool reaches_point(CorrectionStatus status) {
  return status == CorrectionStatus::reached || status == CorrectionStatus::orientation_left ||
         status == CorrectionStatus::turn_limited;
}

/// "reached", "orientation left", ...
const char* correction_status_text(CorrectionStatus status);

struct CorrectionOptions {
  /// Wanted of the tool. Where the machine has no rotary axis that works for it, the orientation is only reported.
  TargetKind target = TargetKind::point_and_direction;
  double position_tolerance = 1e-9;      ///< mm
  double orientation_tolerance = 1e-11;  ///< rad
  /// rad; how far the rotary axes together (root of the sum of squares) may turn from the commands that came. Near a
  /// singularity a small error of orientation would need a large turn: there a part of it stays, and no command jumps
  /// (bounded_least_squares.h).
  double largest_turn = 0.01;
  double largest_shift = 10;  ///< mm; the same of the linear axes, where they are nearly dependent
  int largest_iterations = 30;
};

/// Commands in, commands out; [axes] pointers to [count] values each, chain order, mm or rad.
struct CorrectedArrays {
  std::span<double* const> axis;
  CorrectionStatus* status = nullptr;      ///< [count]
  double* position_residual = nullptr;     ///< [count] mm, actual against wanted point; null: not wanted
  double* orientation_residual = nullptr;  ///< [count] rad, of a direction the angle; 0 for a point; null: not wanted
};

/// Where the tool shall be, in the workpiece frame: functional point (mm), direction from it to the spindle (unit), or
/// row-major rotation of workpiece_from_tool; what the target kind does not ask for may be null.
struct TargetArrays {
  ConstPointArrays point;
  ConstPointArrays direction;
  const double* rotation[9] = {};
};

/// Axis commands that bring the ACTUAL tool of a machine with errors to where it is wanted.
///
/// Newton's method on the exact model (ChainPlan), from commands nearby; the derivative by the commands, errors
/// included, is taken at the start and again where it no longer serves. Rotary axes take the orientation error, within
/// a stated turn; linear axes (or the rotary axis of a polar machine) then take the point exactly. Which axes work is
/// decided as in InverseKinematics; all others keep their command.
///
/// The result of a pose does not depend on the poses computed with it nor on their number. Building allocates; nothing
/// else does. One object may be used by several threads at a time. Method: docs/compensation.md.
class CompensatedInverse {
 public:
  /// @param held  axes that keep their command although they could work, by index
  CompensatedInverse(const Machine& machine, const ErrorSet& errors, const CorrectionOptions& options = {},
                     std::span<const std::size_t> held = {});
  ~CompensatedInverse();
  CompensatedInverse(CompensatedInverse&&) noexcept;
  CompensatedInverse& operator=(CompensatedInverse&&) noexcept;

  /// Commands at which the actual tool is where the nominal machine has it at the given ones. They may be written in
  /// place.
  void correct(PositionArrays commands, const CorrectedArrays& corrected) const;

  /// Commands at which the actual tool is at the targets.
  /// @param start  commands near by, such as those of InverseKinematics for the same targets
  void reach(PositionArrays start, const TargetArrays& targets, const CorrectedArrays& corrected) const;

  /// What makes this object unusable; empty if it is sound. Unusable, every status is not_run.
  const std::string& problem() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace abbe
