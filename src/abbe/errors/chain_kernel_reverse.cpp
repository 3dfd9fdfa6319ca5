#include <cstring>

#include "abbe/errors/chain_kernel_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "abbe/errors/chain_kernel_reverse.cpp"
#include "hwy/foreach_target.h"
// After foreach_target.h:
#include "abbe/errors/chain_kernel_inline.h"
#include "abbe/errors/chain_kernel_slopes_inline.h"
#include "abbe/errors/chain_kernel_sweep_inline.h"

HWY_BEFORE_NAMESPACE();
namespace abbe::chain {
namespace HWY_NAMESPACE {
namespace {

/// Takes the error of a step back: the point before it, its force and moment, and channels EX .. EC.
///
/// A point r from the reference, r3 = R r: a change of EC moves it by ez x r3, of EB by Rz (ey x r2), of EA by
/// Rz Ry (ex x r1), so force and moment are turned back with the point, one angle at a time.
HWY_NOINLINE void take_back_error(const AxisStep& step, std::size_t rows, std::size_t end, Sweep& s) {
  for (std::size_t k = 0; k < end; k += hn::Lanes(Tag())) {
    const Vector3 reference = set3(step.reference), shift = load(s.lanes.error, k);
    const Vector3 half_angles = load(s.lanes.error + 3, k), angles = half_angles + half_angles;
    const Vector3 out = load(s.point, k);
    const ErrorRotation e = error_rotation(angles);
    if (step.first_order) {
      const Vector3 in_first = first_order_inverse(angles, out - reference - shift);  // forwards only
      const Vector3 r_out = out - reference;
      const Vector3 grown = r_out + cross(angles, r_out);  // the inverted step taken back
      store(step.inverted ? grown + reference + shift : in_first + reference, s.point, k);
      for (std::size_t row = 0; row < rows; ++row) {
        const Vector3 f = load(s.force[row], k), m = load(s.moment[row], k);
        Vector3 before, turn_channel;
        if (step.inverted) {
          const Vector3 minus = negative(angles);
          before = first_order_inverse(minus, f);
          turn_channel = cross(before, r_out) - m;
          store(negative(before), s.channel[row], k);
          store(first_order_inverse(minus, m), s.moment[row], k);
        } else {
          before = f - cross(angles, f);
          turn_channel = cross(in_first, f) + m;
          store(f, s.channel[row], k);
          store(m - cross(angles, m), s.moment[row], k);
        }
        store(turn_channel, s.channel[row] + 3, k);
        store(before, s.force[row], k);
      }
      continue;
    }
    if (!step.inverted) {
      const Vector3 r3 = out - reference - shift;
      Vector3 r2 = r3;
      turn_back(e.c, r2.x, r2.y);
      Vector3 r1 = r2;
      turn_back(e.b, r1.z, r1.x);
      Vector3 r0 = r1;
      turn_back(e.a, r0.y, r0.z);
      store(r0 + reference, s.point, k);
      for (std::size_t row = 0; row < rows; ++row) {
        Vector3 f = load(s.force[row], k), m = load(s.moment[row], k);
        store(f, s.channel[row], k);
        const Vector by_c = hn::Add(hn::NegMulAdd(f.x, r3.y, hn::Mul(f.y, r3.x)), m.z);
        turn_back(e.c, f.x, f.y);
        turn_back(e.c, m.x, m.y);
        const Vector by_b = hn::Add(hn::NegMulAdd(f.z, r2.x, hn::Mul(f.x, r2.z)), m.y);
        turn_back(e.b, f.z, f.x);
        turn_back(e.b, m.z, m.x);
        const Vector by_a = hn::Add(hn::NegMulAdd(f.y, r1.z, hn::Mul(f.z, r1.y)), m.x);
        turn_back(e.a, f.y, f.z);
        turn_back(e.a, m.y, m.z);
        store({by_a, by_b, by_c}, s.channel[row] + 3, k);
        store(f, s.force[row], k);
        store(m, s.moment[row], k);
      }
    } else {
      const Vector3 r0 = out - reference;
      Vector3 r1 = r0;
      turn(e.a, r1.y, r1.z);
      Vector3 r2 = r1;
      turn(e.b, r2.z, r2.x);
      Vector3 r3 = r2;
      turn(e.c, r3.x, r3.y);
      store(r3 + reference + shift, s.point, k);
      for (std::size_t row = 0; row < rows; ++row) {
        Vector3 f = load(s.force[row], k), m = load(s.moment[row], k);
        const Vector by_a = hn::Sub(hn::NegMulAdd(f.z, r0.y, hn::Mul(f.y, r0.z)), m.x);
        turn(e.a, f.y, f.z);
        turn(e.a, m.y, m.z);
        const Vector by_b = hn::Sub(hn::NegMulAdd(f.x, r1.z, hn::Mul(f.z, r1.x)), m.y);
        turn(e.b, f.z, f.x);
        turn(e.b, m.z, m.x);
        const Vector by_c = hn::Sub(hn::NegMulAdd(f.y, r2.x, hn::Mul(f.x, r2.y)), m.z);
        turn(e.c, f.x, f.y);
        turn(e.c, m.x, m.y);
        store(negative(f), s.channel[row], k);
        store({by_a, by_b, by_c}, s.channel[row] + 3, k);
        store(f, s.force[row], k);
        store(m, s.moment[row], k);
      }
    }
  }
}

/// Takes the motion of a step back where nobody asks for derivatives by its line and its command.
HWY_NOINLINE void take_back_only_motion(const AxisStep& step, std::size_t rows, std::size_t end, Sweep& s) {
  const Vector3 direction = set3(step.direction), centre = set3(step.centre);
  const Vector sign = set(step.sign);
  const StepVectors vectors = vectors_of(step);
  for (std::size_t k = 0; k < end; k += hn::Lanes(Tag())) {
    const Vector3 out = load(s.point, k);
    if (!step.rotary) {
      const Vector way = hn::Mul(hn::Add(load(s.lanes.position.v + k), set(step.zero_position)), sign);
      store(out - Vector3{hn::Mul(way, direction.x), hn::Mul(way, direction.y), hn::Mul(way, direction.z)}, s.point, k);
      continue;
    }
    const Matrix3 r = rotation(vectors, motion_angle(vectors, {load(s.lanes.sine.v + k), load(s.lanes.cosine.v + k)}));
    store(transposed_times(r, out - centre) + centre, s.point, k);
    for (std::size_t row = 0; row < rows; ++row) {
      store(transposed_times(r, load(s.force[row], k)), s.force[row], k);
      store(transposed_times(r, load(s.moment[row], k)), s.moment[row], k);
    }
  }
}

/// Takes the motion of a step back; channels: 0 .. 2 shifts and 3 .. 5 tilts of the axis line, 6 zero position.
HWY_NOINLINE void take_back_motion(const AxisStep& step, std::size_t rows, std::size_t end, Sweep& s) {
  const Vector3 direction = set3(step.direction), centre = set3(step.centre);
  const Vector3 tilt[3] = {set3(step.tilt_axes[0]), set3(step.tilt_axes[1]), set3(step.tilt_axes[2])};
  const Vector sign = set(step.sign);
  const StepVectors vectors = vectors_of(step);
  for (std::size_t k = 0; k < end; k += hn::Lanes(Tag())) {
    const Vector3 out = load(s.point, k);
    if (!step.rotary) {
      const Vector way = hn::Mul(hn::Add(load(s.lanes.position.v + k), set(step.zero_position)), sign);
      const Vector3 moved = {hn::Mul(way, direction.x), hn::Mul(way, direction.y), hn::Mul(way, direction.z)};
      store(out - moved, s.point, k);
      for (std::size_t row = 0; row < rows; ++row) {
        const Vector3 f = load(s.force[row], k), lever = cross(moved, f);
        store(zero3(), s.channel[row], k);
        store({dot(tilt[0], lever), dot(tilt[1], lever), dot(tilt[2], lever)}, s.channel[row] + 3, k);
        store(hn::Mul(sign, dot(f, direction)), s.channel[row][6].v + k);
      }
      continue;
    }
    const Matrix3 r = rotation(vectors, motion_angle(vectors, {load(s.lanes.sine.v + k), load(s.lanes.cosine.v + k)}));
    const Vector3 r_out = out - centre, r_in = transposed_times(r, r_out);
    store(r_in + centre, s.point, k);
    for (std::size_t row = 0; row < rows; ++row) {
      const Vector3 f = load(s.force[row], k), m = load(s.moment[row], k);
      const Vector3 f_in = transposed_times(r, f), m_in = transposed_times(r, m);
      const Vector3 about = cross(r_out, f) + m;
      const Vector3 change = about - (cross(r_in, f_in) + m_in);
      store(f - f_in, s.channel[row], k);
      store({dot(tilt[0], change), dot(tilt[1], change), dot(tilt[2], change)}, s.channel[row] + 3, k);
      store(hn::Mul(sign, dot(about, direction)), s.channel[row][6].v + k);
      store(f_in, s.force[row], k);
      store(m_in, s.moment[row], k);
    }
  }
}

/// Where a run of parameters stands in the caller's selection: exactly if that is sorted, else all of it is searched.
struct Selection {
  std::span<const std::size_t> parameters;
  bool sorted = false;

  std::size_t begin(std::size_t first) const {
    if (!sorted) return 0;
    return static_cast<std::size_t>(std::lower_bound(parameters.begin(), parameters.end(), first) - parameters.begin());
  }
  std::size_t end(std::size_t past) const { return sorted ? begin(past) : parameters.size(); }
};

/// Where the rows of this sweep stand in the caller's arrays.
struct Target {
  double* jacobian;
  std::size_t stride, count, first_row, rows;
  const FactoredColumns* form;  ///< null: whole columns
  double* bases;
  std::size_t basis_stride;

  /// Where the column of a parameter that has no basis function is written.
  std::size_t place(std::size_t j) const { return form == nullptr ? j : form->columns[j].carrier; }
  /// False if the function of a coefficient is that of an earlier column.
  bool needs_function(std::size_t j) const { return form == nullptr || form->basis_first[form->columns[j].basis] == j; }
};

/// Writes channel times factor (null: 1) as the column of one parameter.
HWY_NOINLINE void write_column(const Target& target, const Sweep& s, int channel, const Lane* factor,
                               std::size_t column) {
  const std::size_t width = hn::Lanes(Tag());
  for (std::size_t row = 0; row < target.rows; ++row) {
    const double* values = s.channel[row][channel].v;
    double* out = target.jacobian + column * target.stride + (target.first_row + row) * target.count;
    std::size_t k = 0;
    for (; k + width <= target.count; k += width) {
      Vector v = load(values + k);
      if (factor != nullptr) v = hn::Mul(v, load(factor->v + k));
      hn::StoreU(v, Tag(), out + k);
    }
    if (k < target.count) {
      Vector v = load(values + k);
      if (factor != nullptr) v = hn::Mul(v, load(factor->v + k));
      store_some(v, target.count - k, out + k);
    }
  }
}

/// The lane itself, or its product with the factor of a state.
HWY_INLINE const Lane* with_state(std::size_t state, const Lane* lane, std::size_t end, StateSweep* states) {
  if (state == kNoState) return lane;
  const double* factor = states->states.factor[state].v;
  for (std::size_t k = 0; k < end; k += hn::Lanes(Tag())) {
    const Vector value = load(factor + k);
    store(lane == nullptr ? value : hn::Mul(load(lane->v + k), value), states->product.v + k);
  }
  return &states->product;
}

/// Writes the column of a coefficient, or those of its factors that no earlier column has.
/// @param function  its basis function; not read if the target does not need it
HWY_NOINLINE void write_coefficient(const Target& target, const Sweep& s, int component, const Lane* function,
                                    std::size_t state, std::size_t end, StateSweep* states, std::size_t j) {
  if (target.form == nullptr) return write_column(target, s, component, with_state(state, function, end, states), j);
  const FactoredColumns::Column& column = target.form->columns[j];
  if (target.form->carrier_first[column.carrier] == j) write_column(target, s, component, nullptr, column.carrier);
  if (!target.needs_function(j)) return;
  const Lane* values = with_state(state, function, end, states);
  std::memcpy(target.bases + column.basis * target.basis_stride, values->v, target.count * sizeof(double));
}

/// Columns of all selected coefficients of one basis, a few functions at a time.
HWY_NOINLINE void write_basis(const CompiledChain& chain, const AxisStep& step, const BasisUse& use,
                              const Selection& selection, const Target& target, std::size_t end, const Sweep& s,
                              StateSweep* states) {
  const bool pieces =
      use.kind == BasisKind::bspline || use.kind == BasisKind::table_linear || use.kind == BasisKind::table_monotone;
  if (pieces) {
    LocalFunctions local;
    find_local_functions(step.groups[use.group], use, chain.numbers.data(), s.lanes, end, local);
    Lane factor;
    for (const BasisUse::Term& term : use.terms) {
      const std::size_t past = term.first_parameter + use.size;
      for (std::size_t j = selection.begin(term.first_parameter); j < selection.end(past); ++j) {
        const std::size_t parameter = selection.parameters[j];
        if (parameter < term.first_parameter || parameter >= past) continue;
        if (target.needs_function(j)) {
          local_function(local, static_cast<double>(parameter - term.first_parameter), end, factor);
        }
        write_coefficient(target, s, term.component, &factor, use.state, end, states, j);
      }
    }
    return;
  }
  FunctionSequence sequence;
  for (std::size_t first = 0; first < use.size;) {
    const std::size_t number = next_functions(use, s.lanes, end, first, sequence);
    for (const BasisUse::Term& term : use.terms) {
      const std::size_t from = term.first_parameter + first;
      const std::size_t past = term.first_parameter + std::min(first + number, use.size);
      for (std::size_t j = selection.begin(from); j < selection.end(past); ++j) {
        const std::size_t parameter = selection.parameters[j];
        if (parameter < from || parameter >= past) continue;
        const Lane* function = &sequence.function[2 + parameter - from];
        write_coefficient(target, s, term.component, function, use.state, end, states, j);
      }
    }
    first += number;
  }
}

HWY_NOINLINE void write_errors(const CompiledChain& chain, const AxisStep& step, const Selection& selection,
                               const Target& target, std::size_t end, bool commands, Sweep& s, StateSweep* states) {
  for (const BasisUse& use : step.bases) write_basis(chain, step, use, selection, target, end, s, states);
  if (!commands) return;
  evaluate_slopes(chain, step, s.lanes, end, states == nullptr ? nullptr : states->states.factor, s.slope);
  if (states != nullptr) add_factors_of_errors(chain, step, target.rows, end, s, *states);
  for (std::size_t row = 0; row < target.rows; ++row) {
    for (std::size_t k = 0; k < end; k += hn::Lanes(Tag())) {
      Vector sum = load(s.by_command[row].v + k);
      for (int c = 0; c < 6; ++c) sum = hn::MulAdd(load(s.channel[row][c].v + k), load(s.slope[c].v + k), sum);
      store(sum, s.by_command[row].v + k);
    }
  }
}

bool locations_wanted(const AxisStep& step, const Selection& selection) {
  return std::any_of(step.locations.begin(), step.locations.end(), [&](const AxisStep::Location& location) {
    const std::size_t begin = selection.begin(location.parameter), end = selection.end(location.parameter + 1);
    const std::span<const std::size_t> found = selection.parameters.subspan(begin, end - begin);
    return std::find(found.begin(), found.end(), location.parameter) != found.end();
  });
}

/// Columns of the location errors of a step.
HWY_NOINLINE void write_motion(const AxisStep& step, const Selection& selection, const Target& target, std::size_t end,
                               bool commands, Sweep& s, StateSweep* states) {
  for (const AxisStep::Location& location : step.locations) {
    for (std::size_t j = selection.begin(location.parameter); j < selection.end(location.parameter + 1); ++j) {
      if (selection.parameters[j] != location.parameter) continue;
      if (location.only < 0) combine(location, target.rows, end, s);
      write_column(target, s, location.only < 0 ? 7 : location.only, with_state(location.state, nullptr, end, states),
                   target.place(j));
    }
  }
  if (!commands) return;
  for (std::size_t row = 0; row < target.rows; ++row) {
    for (std::size_t k = 0; k < end; k += hn::Lanes(Tag())) {
      store(hn::Add(load(s.by_command[row].v + k), load(s.channel[row][6].v + k)), s.by_command[row].v + k);
    }
  }
}

/// Columns of the tool offset error: the force there, times sign.
HWY_NOINLINE void write_tool(const CompiledChain& chain, const Selection& selection, const Target& target, double sign,
                             std::size_t end, Sweep& s) {
  for (std::size_t row = 0; row < target.rows; ++row) {
    for (std::size_t k = 0; k < end; k += hn::Lanes(Tag())) {
      for (int i = 0; i < 3; ++i) store(hn::Mul(set(sign), load(s.force[row][i].v + k)), s.channel[row][i].v + k);
    }
  }
  const std::size_t first = chain.tool_parameter;
  for (std::size_t j = selection.begin(first); j < selection.end(first + 3); ++j) {
    const std::size_t parameter = selection.parameters[j];
    if (parameter >= first) write_column(target, s, static_cast<int>(parameter - first), nullptr, target.place(j));
  }
}

/// Force, moment and (unless null) point before a constant transform that was applied to them.
HWY_NOINLINE void take_back_constant(const ConstantTransform& transform, std::size_t rows, std::size_t end, Sweep& s) {
  const Matrix3 turn = set_matrix(transform.rotation);
  const Vector3 offset = set3(transform.offset);
  for (std::size_t k = 0; k < end; k += hn::Lanes(Tag())) {
    const Vector3 r = load(s.point, k) - offset;
    store(transform.turns ? transposed_times(turn, r) : r, s.point, k);
    if (!transform.turns) continue;
    for (std::size_t row = 0; row < rows; ++row) {
      store(transposed_times(turn, load(s.force[row], k)), s.force[row], k);
      store(transposed_times(turn, load(s.moment[row], k)), s.moment[row], k);
    }
  }
}

HWY_NOINLINE void read_rows(const DifferentiateCall& call, std::size_t first_row, std::size_t rows, Sweep& s) {
  const std::size_t count = call.positions.count;
  read_lane(call.seen.x, count, s.point[0]);
  read_lane(call.seen.y, count, s.point[1]);
  read_lane(call.seen.z, count, s.point[2]);
  for (std::size_t row = 0; row < rows; ++row) {
    const RowArrays& r = call.rows[first_row + row];
    read_lane(r.force.x, count, s.force[row][0]);
    read_lane(r.force.y, count, s.force[row][1]);
    read_lane(r.force.z, count, s.force[row][2]);
    if (r.moment.x != nullptr) {
      read_lane(r.moment.x, count, s.moment[row][0]);
      read_lane(r.moment.y, count, s.moment[row][1]);
      read_lane(r.moment.z, count, s.moment[row][2]);
    } else {
      for (Lane& lane : s.moment[row]) std::memset(lane.v, 0, sizeof lane.v);
    }
  }
}

/// @param states  null for a chain without states
void differentiate_with(const CompiledChain& chain, const DifferentiateCall& call, std::size_t first_row,
                        std::size_t rows, StateSweep* states) {
  const std::size_t count = call.positions.count, end = whole_vectors(count);
  const Lane* factor = states == nullptr ? nullptr : states->states.factor;
  Sweep s;
  read_rows(call, first_row, rows, s);
  const Selection selection{call.parameters, std::is_sorted(call.parameters.begin(), call.parameters.end())};
  const Target target{call.jacobian, call.stride, count, first_row, rows, call.form, call.bases, call.basis_stride};
  for (std::size_t j = 0; j < call.parameters.size(); ++j) {
    if (chain.influences[call.parameters[j]] != 0) continue;
    std::fill_n(call.jacobian + target.place(j) * call.stride + first_row * count, rows * count, 0.0);
    if (call.form == nullptr || call.form->columns[j].basis == FactoredColumns::kOne) continue;
    std::fill_n(call.bases + call.form->columns[j].basis * call.basis_stride, count, 0.0);
  }
  if (call.by_position != nullptr) {
    for (std::size_t axis = 0; axis < call.positions.axis.size(); ++axis) {
      std::fill_n(call.by_position + (axis * call.rows.size() + first_row) * count, rows * count, 0.0);
    }
  }

  if (chain.ends_at_tool) write_tool(chain, selection, target, -1.0, end, s);
  take_back_constant(chain.end, rows, end, s);
  for (std::size_t i = chain.steps.size(); i-- > 0;) {
    const AxisStep& step = chain.steps[i];
    const bool commands = call.by_position != nullptr;
    evaluate_axis(chain, step, call.positions.axis[step.axis], count, s.lanes, factor);
    for (std::size_t row = 0; commands && row < rows; ++row) {
      std::memset(s.by_command[row].v, 0, sizeof s.by_command[row].v);
    }
    if (step.has_errors && !step.error_first) {
      take_back_error(step, rows, end, s);
      write_errors(chain, step, selection, target, end, commands, s, states);
    }
    if (step.moving_line) {
      displace_lines(step, factor, end, states->line);
      take_back_moving_motion(step, rows, end, states->line, s);
      if (commands) add_factors_of_locations(chain, step, rows, end, s, *states);
    } else if (commands || locations_wanted(step, selection)) {
      take_back_motion(step, rows, end, s);
    } else {
      take_back_only_motion(step, rows, end, s);
    }
    write_motion(step, selection, target, end, commands, s, states);
    if (step.has_errors && step.error_first) {
      take_back_error(step, rows, end, s);
      write_errors(chain, step, selection, target, end, commands, s, states);
    }
    if (!commands) continue;
    for (std::size_t row = 0; row < rows; ++row) {
      std::memcpy(call.by_position + (step.axis * call.rows.size() + first_row + row) * count, s.by_command[row].v,
                  count * sizeof(double));
    }
  }
  take_back_constant(chain.start, rows, end, s);
  if (chain.starts_at_tool) write_tool(chain, selection, target, 1.0, end, s);
  if (states != nullptr && call.by_position != nullptr) {
    add_factors_of_commands(chain, call, first_row, rows, end, *states);
  }
  if (call.by_start == nullptr) return;
  for (std::size_t row = 0; row < rows; ++row) {
    const PointArrays& out = call.by_start[first_row + row];
    std::memcpy(out.x, s.force[row][0].v, count * sizeof(double));
    std::memcpy(out.y, s.force[row][1].v, count * sizeof(double));
    std::memcpy(out.z, s.force[row][2].v, count * sizeof(double));
  }
}

HWY_NOINLINE void differentiate_with_states(const CompiledChain& chain, const DifferentiateCall& call,
                                            std::size_t first_row, std::size_t rows) {
  StateSweep states;
  evaluate_states(chain, call.positions, 0, call.positions.count, states.states);
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t s = 0; s < chain.states.size(); ++s) {
      std::memset(states.by_factor[row][s].v, 0, sizeof states.by_factor[row][s].v);
    }
  }
  differentiate_with(chain, call, first_row, rows, &states);
}

void differentiate_rows(const CompiledChain& chain, const DifferentiateCall& call, std::size_t first_row,
                        std::size_t rows) {
  if (call.positions.count == 0) return;
  if (chain.states.empty()) {
    differentiate_with(chain, call, first_row, rows, nullptr);
  } else {
    differentiate_with_states(chain, call, first_row, rows);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace abbe::chain
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace abbe::chain {

HWY_EXPORT(differentiate_rows);

void differentiate_rows(const CompiledChain& chain, const DifferentiateCall& call, std::size_t first_row,
                        std::size_t row_count) {
  HWY_DYNAMIC_DISPATCH(differentiate_rows)(chain, call, first_row, row_count);
}

}  // namespace abbe::chain
#endif
