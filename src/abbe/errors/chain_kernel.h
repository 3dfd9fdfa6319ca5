#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "abbe/errors/basis.h"
#include "abbe/errors/chain_plan.h"

/// Inside of ChainPlan: the compiled chain as plain data, and the vectorised functions that interpret it. Not an
/// interface.
namespace abbe::chain {

/// How the sum of all terms of one component is evaluated.
enum class Form { power, chebyshev, fourier, pieces };

/// Polynomials with more coefficients are kept as Chebyshev series: their power form would lose digits.
inline constexpr std::size_t kLargestPowerSize = 9;

/// Fourier series with at most this many harmonics are evaluated as powers of the cosine: P(cos) + sin Q(cos).
inline constexpr std::size_t kMostHarmonicPowers = 8;

/// One component of an error motion, mm or rad, as a function of the scaled argument of its group.
///
/// Series of EA, EB and EC give half of the angle, from which a rotation takes fewer operations.
struct Series {
  int component = 0;     ///< 0 .. 5: EX .. EC
  std::size_t size = 0;  ///< power, chebyshev: coefficients; fourier: harmonics; pieces: intervals
  std::size_t first =
      0;  ///< index into CompiledChain::numbers; power, chebyshev: c0, c1, ...; fourier: mean, cos1, sin1,
          ///< ...; pieces: four powers of the local position per interval
  std::size_t powers = 0;  ///< fourier with few harmonics: index into numbers; [size + 1] of P, [size] of Q

  bool gives_half() const { return component >= 3; }
};

/// Series of one axis that share their argument, so that it (or its sine, or its interval) is computed once.
struct FunctionGroup {
  Form form = Form::power;
  double centre = 0;  ///< argument = (q - centre) * scale
  double scale = 1;
  bool shares_turn = false;  ///< fourier: the argument is the axis's own angle, whose sine the motion needs anyway
  // pieces only:
  double start = 0;         ///< position of the first break
  double period = 0;        ///< 0: not periodic
  double inverse_step = 0;  ///< 1 / length of equal intervals; 0: the interval is searched
  std::size_t breaks = 0;   ///< index into numbers: [pieces] starts, then [pieces] inverse lengths
  std::size_t pieces = 0;
  bool straight = false;         ///< all pieces are straight lines
  std::size_t state = kNoState;  ///< index into CompiledChain::states
  std::vector<Series> series;
};

/// Terms with the same basis on one axis: their basis functions are computed once for the Jacobian.
struct BasisUse {
  struct Term {
    int component = 0;
    std::size_t first_parameter = 0;
  };
  BasisKind kind = BasisKind::legendre;
  std::size_t size = 0;
  double centre = 0;
  double scale = 1;
  bool shares_turn = false;
  std::size_t group = 0;    ///< pieces: the group that finds the interval
  std::size_t weights = 0;  ///< pieces: index into numbers, per interval 4 functions of 4 powers of the local position
  int first_function = 0;   ///< pieces: function 0 of interval i is number i + first_function, modulo size
  std::size_t state = kNoState;  ///< index into CompiledChain::states
  std::vector<Term> terms;
};

/// One axis on the way from one body to the other: its motion and its error motion.
struct AxisStep {
  struct Location {
    std::size_t parameter = 0;
    double effect[7] = {};         ///< of one unit: 0 .. 2 shifts, 3 .. 5 tilts, 6 zero position
    int only = -1;                 ///< the one of them that is 1 where all others are 0; -1: several
    std::size_t state = kNoState;  ///< index into CompiledChain::states
    double value = 0;              ///< with a state: present value of the parameter
  };
  std::size_t axis = 0;
  bool rotary = false;
  bool inverted = false;     ///< traversed from the bed towards the carried body
  bool error_first = false;  ///< the error is applied to the point before the motion
  bool has_errors = false;
  bool has_angles = false;  ///< any of EA, EB, EC
  bool first_order = false;
  double sign = 1;  ///< displacement = sign * (q + zero_position); sense of the axis, negative if inverted
  double zero_position = 0;
  double zero_sine = 0, zero_cosine = 1;
  double direction[3] = {};           ///< of the displaced axis line
  double signed_direction[3] = {};    ///< sign times it
  double direction_products[6] = {};  ///< xx, yy, zz, xy, xz, yz of it
  double centre[3] = {};              ///< a point on it
  double reference[3] = {};           ///< Axis::point
  double before[3] = {};              ///< what the first of error and motion turns about: reference or centre
  double between[3] = {};             ///< that minus what the second turns about
  double after[3] = {};               ///< what the second turns about
  bool has_offsets = false;           ///< any of these is not zero
  double tilt_axes[3][3] = {};        ///< [k]: axis about which EA0, EB0, EC0 turns the line
  double lowest = 0, highest = 0;     ///< positions covered by all terms
  std::vector<FunctionGroup> groups;  ///< those without a state first
  std::size_t plain_groups = 0;       ///< how many have no state
  std::vector<BasisUse> bases;
  std::vector<Location> locations;
  bool moving_line = false;          ///< a location error has a state: the line is another one at every pose
  double nominal_direction[3] = {};  ///< the line before its location errors
  double fixed_effect[7] = {};       ///< of the location errors without a state together, as Location::effect
};

/// Loads of one axis, together: the torque needs no more of them.
struct CarriedLoads {
  std::size_t at = 0;     ///< index into WeighedSide::axes
  double mass = 0;        ///< kg
  double moment[3] = {};  ///< sum of mass times point, kg mm, all axes at zero
};

/// How the factor of a state is found.
struct StateSource {
  StateKind kind = StateKind::measured;
  std::size_t given = 0;  ///< measured, lag, approach: index into PositionArrays::state
  double reference = 0;
  std::size_t axis = 0;               ///< axis: index into PositionArrays::axis
  std::size_t first = 0, second = 0;  ///< product: indices into CompiledChain::states, below its own
  std::size_t side = 0;               ///< gravity: index into CompiledChain::sides
  std::size_t about = 0;              ///< gravity: index into WeighedSide::axes
  std::vector<CarriedLoads> loads;
  bool moves = false;  ///< depends on commands
};

/// Nominal axes from the bed outwards, as far as loads are carried.
struct WeighedSide {
  struct Line {
    std::size_t axis = 0;
    bool rotary = false;
    double sense = 1;
    double direction[3] = {};
    double point[3] = {};
  };
  std::vector<Line> axes;
};

struct ConstantTransform {
  bool turns = false;
  double rotation[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};  ///< row-major
  double offset[3] = {};
};

struct CompiledChain {
  ConstantTransform start;  ///< from the frame of `from` to the machine frame with all axes at zero
  ConstantTransform end;    ///< from there to the frame of `to`
  std::vector<AxisStep> steps;
  std::vector<double> numbers;
  std::vector<std::uint8_t> influences;  ///< [parameter_count] 1 where a step or a tool offset uses it
  std::size_t tool_parameter = 0;        ///< first of three
  std::vector<StateSource> states;       ///< that errors of the steps use, products last; at most kMaxStates
  std::vector<WeighedSide> sides;
  double weight[3] = {};  ///< gravity, 1e-3 m/s^2: times kg mm it gives N m
  bool starts_at_tool = false, ends_at_tool = false;
  bool first_order = false;
};

/// Rows of the Jacobian treated in one sweep.
inline constexpr std::size_t kRowsAtOnce = 6;

/// Arguments of ChainPlan::differentiate().
struct DifferentiateCall {
  PositionArrays positions;
  ConstPointArrays seen;
  std::span<const RowArrays> rows;
  std::span<const std::size_t> parameters;
  double* jacobian = nullptr;
  std::size_t stride = 0;
  const PointArrays* by_start = nullptr;
  double* by_position = nullptr;
  const FactoredColumns* form = nullptr;  ///< then jacobian has the carriers
  double* bases = nullptr;
  std::size_t basis_stride = 0;
};

/// Poses first .. first + count - 1, count <= ChainPlan::kBlockSize.
void transform_block(const CompiledChain& chain, const PositionArrays& positions, std::size_t first, std::size_t count,
                     const ConstPointArrays& start, const PointArrays& seen, const RotationArrays& rotation,
                     std::uint8_t* covered);

/// Rows first_row .. first_row + row_count - 1, row_count <= kRowsAtOnce.
void differentiate_rows(const CompiledChain& chain, const DifferentiateCall& call, std::size_t first_row,
                        std::size_t row_count);

}  // namespace abbe::chain
