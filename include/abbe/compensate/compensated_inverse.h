#pragma once

// Commands at which the tool of a mill out of square is where it should be:
//
//   #include <abbe/compensate/compensated_inverse.h>
//   #include <abbe/machine/chain.h>
//
//   #include <cstdio>
//
//   int main() {
//     const abbe::Machine mill = abbe::parse_chain("w X' Y' b Z t").machine;
//     abbe::ErrorSet errors;  // squareness of Y to X: 20 um/m
//     errors.locations.push_back({.axis = mill.find_axis("Y"), .component = abbe::Component::C, .value = 20e-6});
//     const abbe::CompensatedInverse inverse(mill, errors);
//
//     double x[] = {0, 100, 200}, y[] = {0, 100, 200}, z[] = {0, 0, 50};  // mm, commands of three poses
//     const double* nominal[] = {x, y, z};
//     double* corrected[] = {x, y, z};  // the same memory: they are corrected in place
//     abbe::CorrectionStatus status[3];
//     inverse.correct({nominal, 3}, {corrected, status});
//     for (int k = 0; k < 3; ++k) {
//       std::printf("X %.4f Y %.4f Z %.4f mm: %s\n", x[k], y[k], z[k], abbe::correction_status_text(status[k]));
//       if (!abbe::reaches_point(status[k])) return 1;
//     }
//     return 0;
//   }
//
// It prints:
//
//   X 0.0000 Y 0.0000 Z 0.0000 mm: reached
//   X 100.0020 Y 100.0000 Z 0.0000 mm: reached
//   X 200.0040 Y 200.0000 Z 50.0000 mm: reached
//
// The headers of compensate correct commands:
//   compensated_inverse.h               poses of any number, from commands or from targets
//   corrected_poses.h                   the same with uncertainties and summary figures
//   program/program_correction.h        moves of a program, proven to stay within a tolerance
//   tables/correction_lattice.h         corrections at the nodes of tables: axis_table.h, error_tables.h beside it
//   left_out_errors.h                   errors that are smaller than their uncertainty

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

/// The point is reached; the orientation is as close as the machine can bring it.
inline bool reaches_point(CorrectionStatus status) {
  return status == CorrectionStatus::reached || status == CorrectionStatus::orientation_left ||
         status == CorrectionStatus::turn_limited;
}

/// "reached", "orientation left", ...
const char* correction_status_text(CorrectionStatus status);

struct CorrectionOptions {
  /// What the tool has to reach. Where no rotary axis of the machine can serve it, the orientation is only reported.
  TargetKind target = TargetKind::point_and_direction;
  double position_tolerance = 1e-9;      ///< mm
  double orientation_tolerance = 1e-11;  ///< rad
  /// rad; how far the rotary axes together (root of the sum of squares) may turn from the given commands. Near a
  /// singularity a small orientation error would need a large turn: there part of the error remains, and no command
  /// jumps (bounded_least_squares.h).
  double largest_turn = 0.01;
  double largest_shift = 10;  ///< mm; the same for linear axes, where they are nearly dependent
  int largest_iterations = 30;
};

/// Commands in, commands out; [axes] pointers to [count] values each, chain order, mm or rad.
struct CorrectedArrays {
  std::span<double* const> axis;
  CorrectionStatus* status = nullptr;      ///< [count]
  double* position_residual = nullptr;     ///< [count] mm, actual from target point; null: not computed
  double* orientation_residual = nullptr;  ///< [count] rad, angle for a direction; 0 for a point; null: not computed
};

/// Targets for the tool in the workpiece frame: functional point (mm), and the direction from it to the spindle (unit)
/// or the row-major rotation of workpiece_from_tool. What the target kind does not need may be null.
struct TargetArrays {
  ConstPointArrays point;
  ConstPointArrays direction;
  const double* rotation[9] = {};
};

/// Axis commands that bring the ACTUAL tool of a machine with errors to its target.
///
/// Newton's method on the exact model (ChainPlan), from commands nearby; the derivative by the commands is the nominal
/// one, or the actual one where the nominal one is not good enough. Rotary axes take the orientation error, within
/// a stated turn; linear axes (or the rotary axis of a polar machine) then take the point exactly. The axes of a
/// jointed arm take both together, near a singularity the point first. Which axes work is decided as in
/// InverseKinematics; all others keep their command.
///
/// The result of a pose does not depend on the poses computed with it nor on their number. Building allocates; nothing
/// else does, but reach() with arms. One object may be used by several threads at a time. Method: docs/compensation.md.
class CompensatedInverse {
 public:
  /// @param held  axes that keep their command although they could work, by index
  CompensatedInverse(const Machine& machine, const ErrorSet& errors, const CorrectionOptions& options = {},
                     std::span<const std::size_t> held = {});
  ~CompensatedInverse();
  CompensatedInverse(CompensatedInverse&&) noexcept;
  CompensatedInverse& operator=(CompensatedInverse&&) noexcept;

  /// Commands at which the actual tool is where the nominal machine has it at the given ones. They may be written in
  /// place. States that are computed from commands follow the corrected ones; poses that do not give an input state of
  /// the errors are not_covered.
  void correct(PositionArrays commands, const CorrectedArrays& corrected) const;

  /// Commands at which the actual tool is at the targets.
  /// @param start  commands near by, such as those of InverseKinematics for the same targets. A jointed arm starts from
  ///               the nominal solution nearest to them, wherever it is. Where a status says "as they came", it means
  ///               that solution.
  void reach(PositionArrays start, const TargetArrays& targets, const CorrectedArrays& corrected) const;

  /// What makes this object unusable; empty if it is sound. Unusable, every status is not_run.
  const std::string& problem() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace abbe
