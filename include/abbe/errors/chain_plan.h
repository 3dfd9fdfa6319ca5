#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "abbe/errors/error_set.h"
#include "abbe/errors/factored_columns.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// A body of the machine in whose frame a point is given or seen.
enum class Body { bed, workpiece, tool };

/// Axis commands of many poses, structure of arrays: axis[i][k] is the command of axis i (chain order) at pose k; mm or
/// rad.
struct PositionArrays {
  std::span<const double* const> axis;  ///< [axes] pointers to [count] values, no alignment needed
  std::size_t count = 0;
  /// [states] of the machine, pointers to [count] values or null where not given: values of measured and lag states in
  /// their unit, sides of approach. Empty: nothing is given. Others are computed from the commands.
  std::span<const double* const> state{};
};

struct ConstPointArrays {
  const double* x = nullptr;
  const double* y = nullptr;
  const double* z = nullptr;
};
struct PointArrays {
  double* x = nullptr;
  double* y = nullptr;
  double* z = nullptr;
};
/// Row-major elements r[3 * row + column], each [count]; all null: not wanted. Or one column alone, which is quicker.
struct RotationArrays {
  double* r[9] = {};
};

/// One scalar quantity per pose, differentiated: its change for a small displacement (t, w) of the observed point,
/// t its shift and w the rotation of the body that carries it, is force . t + moment . w. Frame of the observing body.
/// moment pointers may be null (quantities that depend on the point only).
struct RowArrays {
  ConstPointArrays force;
  ConstPointArrays moment;
};

/// A chain between two bodies with its errors, compiled to a short list of operations and evaluated over many poses.
///
/// Exact composition as in actual_pose.h, in double precision, vectorised with run-time dispatch. Building a plan
/// allocates; nothing else does. One plan may be used by several threads at a time.
class ChainPlan {
 public:
  /// Points given in the frame of `from` are seen from `to`. A point of the tool is given from the gauge point
  /// (Machine::tool_reference), in axes parallel to the machine's with all axes at zero; ErrorSet::tool_offset_error
  /// is NOT added (the caller adds what belongs to its own target). A point of the workpiece is given in the workpiece
  /// frame, of the bed in the machine frame.
  ChainPlan(const Machine& machine, const ErrorSet& errors, Body from, Body to);
  ~ChainPlan();
  ChainPlan(ChainPlan&&) noexcept;
  ChainPlan& operator=(ChainPlan&&) noexcept;

  /// New values for all coefficients, in the order of ErrorSet::parameters(); does not allocate.
  void set_parameters(std::span<const double> values);

  /// Largest number of poses per call of differentiate(); transform() takes any number.
  static constexpr std::size_t kBlockSize = 128;

  /// Seen points and, if wanted, rotation (to_from_from: columns are the axes of `from` seen in `to`).
  /// @param start    [count] points in the frame of `from`, mm
  /// @param seen     [count] points in the frame of `to`, mm; may alias start
  /// @param covered  if not null: [count], 0 where a position lies outside the range of an error motion (extrapolation)
  ///                 or an input state of the errors is not given; what is seen is then NaN
  void transform(PositionArrays positions, ConstPointArrays start, PointArrays seen, RotationArrays rotation = {},
                 std::uint8_t* covered = nullptr) const;

  /// Rows of the Jacobian of scalar quantities with respect to selected parameters.
  ///
  /// @param positions   count <= kBlockSize
  /// @param start       [count] points in the frame of `from`, mm; not read at present (the sweep starts where the
  /// points
  ///                    are seen), may be null
  /// @param seen        [count] as transform() gave them
  /// @param rows        quantities, each with arrays of [count]
  /// @param parameters  indices into ErrorSet::parameters(); fastest in increasing order. The tool offset error: from
  /// the
  ///                    tool, the derivative by a shift of the start point; to the tool, that of a quantity from whose
  ///                    seen point the offset is subtracted; else 0.
  /// @param jacobian    out: jacobian[parameter * stride + row * count + k], parameter and row counted in the
  ///                    arguments' order; stride >= rows * count. Parameters without influence give 0.
  /// @param by_start    if not null: out, derivative by the start point: by_start[row].{x,y,z}[k], per mm
  /// @param by_position if not null: out, by_position[(axis * rows + row) * count + k]: derivative by the axis command,
  ///                    of states that are computed from commands too
  void differentiate(PositionArrays positions, ConstPointArrays start, ConstPointArrays seen,
                     std::span<const RowArrays> rows, std::span<const std::size_t> parameters, double* jacobian,
                     std::size_t stride, const PointArrays* by_start = nullptr, double* by_position = nullptr) const;

  /// The same with the factors of the columns in place of the columns.
  ///
  /// @param form          factored_columns() of the errors and `parameters`
  /// @param carriers      out: carriers[carrier * stride + row * count + k]; stride >= rows * count
  /// @param bases         out: bases[basis * basis_stride + k]; basis_stride >= count. Carriers and basis functions
  ///                      of parameters without influence are 0.
  void differentiate_factored(PositionArrays positions, ConstPointArrays seen, std::span<const RowArrays> rows,
                              std::span<const std::size_t> parameters, const FactoredColumns& form, double* carriers,
                              std::size_t stride, double* bases, std::size_t basis_stride,
                              const PointArrays* by_start = nullptr, double* by_position = nullptr) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace abbe
