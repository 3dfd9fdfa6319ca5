// Error motions over a block of poses, compiled once per processor generation (no #pragma once: Highway includes this
// file again for each target).

#include <algorithm>
#include <cstddef>
#include <type_traits>

#include "abbe/errors/chain_kernel.h"
#include "hwy/highway.h"

#if defined(ABBE_ERRORS_CHAIN_KERNEL_INLINE_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_ERRORS_CHAIN_KERNEL_INLINE_H_
#undef ABBE_ERRORS_CHAIN_KERNEL_INLINE_H_
#else
#define ABBE_ERRORS_CHAIN_KERNEL_INLINE_H_
#endif

#include "abbe/errors/chain_kernel_turns_inline.h"

HWY_BEFORE_NAMESPACE();
namespace abbe::chain {
namespace HWY_NAMESPACE {

/// Commands of one axis over the block, and what its error motions and its motion are made of.
struct AxisLanes {
  Lane position;
  Lane sine, cosine;  ///< of the command, rotary axes only
  Lane error[6];      ///< EX, EY, EZ, mm; half of EA, EB, EC, rad
};

HWY_INLINE std::size_t whole_vectors(std::size_t count) {
  const std::size_t n = hn::Lanes(Tag());
  return (count + n - 1) / n * n;
}

/// Values k .. of an array of `count`, past its end the last one.
HWY_INLINE Vector read(const double* from, std::size_t k, std::size_t count) {
  if (HWY_LIKELY(k + hn::Lanes(Tag()) <= count)) return hn::LoadU(Tag(), from + k);
  if (k + 1 == count) return set(from[k]);
  Lane tail;
  for (std::size_t i = 0; i < hn::Lanes(Tag()); ++i) tail.v[i] = from[std::min(k + i, count - 1)];
  return load(tail.v);
}

/// Copies count values and fills up to whole vectors with the last one.
inline HWY_NOINLINE void read_lane(const double* from, std::size_t count, Lane& to) {
  for (std::size_t k = 0; k < count; k += hn::Lanes(Tag())) store(read(from, k, count), to.v + k);
}

/// The first values of a vector only.
HWY_INLINE void store_some(Vector v, std::size_t number, double* out) {
  Lane tail;
  store(v, tail.v);
  for (std::size_t i = 0; i < number; ++i) out[i] = tail.v[i];
}

/// Interval and local position (0 to 1) of pieces.
struct Piece {
  Vector index;  ///< a whole number
  Vector local;
  Vector inverse_length;  ///< 1 / mm or 1 / rad
};

HWY_INLINE hn::Vec<IndexTag> whole_index(Vector index) {
  // Adding 2^52 leaves a small whole number in the low bits; exact, and cheap on every processor.
  const IndexTag di;
  const auto bits = hn::BitCast(di, hn::Add(index, set(4503599627370496.0)));
  return hn::And(bits, hn::Set(di, 0xFFFFFFFFLL));
}

HWY_INLINE Piece find_piece(const FunctionGroup& group, const double* numbers, Vector q) {
  const Tag d;
  const Vector last = set(static_cast<double>(group.pieces - 1)), zero = hn::Zero(d);
  if (group.period > 0) {
    const Vector turns = hn::Floor(hn::Div(hn::Sub(q, set(group.start)), set(group.period)));
    q = hn::NegMulAdd(turns, set(group.period), q);
  }
  if (group.inverse_step > 0) {
    const Vector t = hn::Mul(hn::Sub(q, set(group.start)), set(group.inverse_step));
    // Min and Max order: a position that is no number must still give a valid index.
    const Vector index = hn::Max(hn::Min(hn::Floor(t), last), zero);
    const Vector safe = hn::IfThenElse(hn::Eq(t, t), index, zero);
    return {safe, hn::Sub(t, safe), set(group.inverse_step)};
  }
  const double* starts = numbers + group.breaks;
  std::size_t step = 1;
  while (step < group.pieces) step *= 2;
  Vector index = zero;
  for (step /= 2; step > 0; step /= 2) {
    const Vector candidate = hn::Min(hn::Add(index, set(static_cast<double>(step))), last);
    const Vector begin = hn::GatherIndex(d, starts, whole_index(candidate));
    index = hn::IfThenElse(hn::Le(begin, q), candidate, index);
  }
  const auto at = whole_index(index);
  const Vector inverse_length = hn::GatherIndex(d, starts + group.pieces, at);
  return {index, hn::Mul(hn::Sub(q, hn::GatherIndex(d, starts, at)), inverse_length), inverse_length};
}

HWY_INLINE void add_to(double* out, bool add, Vector value) { store(add ? hn::Add(load(out), value) : value, out); }

/// Horner with the number of coefficients known, so that nothing but multiply-adds is left.
template <std::size_t kSize>
HWY_INLINE Vector horner(const Vector* c, Vector s) {
  Vector value = c[kSize - 1];
  for (std::size_t n = kSize - 1; n-- > 0;) value = hn::MulAdd(value, s, c[n]);
  return value;
}

/// Calls value(k) for all vectors of the block, and writes or adds what it gives; two at a time, because every call is
/// short.
template <class Value>
HWY_INLINE void for_vectors(std::size_t end, bool add, Lane& out, Value value) {
  const std::size_t width = hn::Lanes(Tag());
  std::size_t k = 0;
  for (; k + 2 * width <= end; k += 2 * width) {
    const Vector first = value(k), second = value(k + width);
    add_to(out.v + k, add, first);
    add_to(out.v + k + width, add, second);
  }
  for (; k < end; k += width) add_to(out.v + k, add, value(k));
}

/// One power series over the block; its coefficients stay in registers.
template <std::size_t kSize>
HWY_INLINE void evaluate_powers(const double* c, const Lane& argument, std::size_t end, bool add, Lane& out) {
  Vector coefficient[kSize];
  for (std::size_t n = 0; n < kSize; ++n) coefficient[n] = set(c[n]);
  for_vectors(end, add, out, [&](std::size_t k) HWY_ATTR { return horner<kSize>(coefficient, load(argument.v + k)); });
}

inline HWY_NOINLINE void evaluate_chebyshev(const Series& series, const double* c, const Lane& argument,
                                            std::size_t end, bool add, Lane& out) {
  for_vectors(end, add, out, [&](std::size_t k) HWY_ATTR {
    const Vector s = load(argument.v + k);
    Vector before = hn::Zero(Tag()), value = set(c[series.size - 1]);
    for (std::size_t n = series.size - 1; n-- > 0;) {
      const Vector next = hn::MulAdd(n > 0 ? hn::Add(s, s) : s, value, hn::Sub(set(c[n]), before));
      before = value;
      value = next;
    }
    return value;
  });
}

/// Calls function(number) with the number as a constant: 1 .. kMost.
template <std::size_t kMost, class Function>
HWY_INLINE void with_constant(std::size_t number, Function function) {
  if constexpr (kMost == 1) {
    function(std::integral_constant<std::size_t, 1>());
  } else if (number == kMost) {
    function(std::integral_constant<std::size_t, kMost>());
  } else {
    with_constant<kMost - 1>(number, function);
  }
}

/// All series of a group of polynomials over the block.
inline HWY_NOINLINE void evaluate_polynomials(const FunctionGroup& group, const double* numbers, const AxisLanes& lanes,
                                              std::size_t end, unsigned written, Lane* out) {
  Lane argument;
  for (std::size_t k = 0; k < end; k += hn::Lanes(Tag())) {
    const Vector q = load(lanes.position.v + k);
    store(hn::Mul(hn::Sub(q, set(group.centre)), set(group.scale)), argument.v + k);
  }
  for (const Series& series : group.series) {
    const double* c = numbers + series.first;
    const bool add = (written >> series.component & 1) != 0;
    Lane& to = out[series.component];
    if (group.form == Form::chebyshev) {
      evaluate_chebyshev(series, c, argument, end, add, to);
    } else {
      with_constant<kLargestPowerSize>(series.size,
                                       [&](auto size) HWY_ATTR { evaluate_powers<size()>(c, argument, end, add, to); });
    }
    written |= 1u << series.component;
  }
}

HWY_INLINE SineCosine fourier_argument(double scale, bool shares_turn, const AxisLanes& lanes, std::size_t k) {
  if (shares_turn) return {load(lanes.sine.v + k), load(lanes.cosine.v + k)};
  return sine_cosine(hn::Mul(load(lanes.position.v + k), set(scale)));
}

/// P(cosine) + sine Q(cosine) over the block.
template <std::size_t kNumber>
HWY_INLINE void evaluate_harmonic_powers(const double* c, const Lane& cosine, const Lane& sine, std::size_t end,
                                         bool add, Lane& out) {
  Vector p[kNumber + 1], q[kNumber];
  for (std::size_t n = 0; n <= kNumber; ++n) p[n] = set(c[n]);
  for (std::size_t n = 0; n < kNumber; ++n) q[n] = set(c[kNumber + 1 + n]);
  for_vectors(end, add, out, [&](std::size_t k) HWY_ATTR {
    const Vector x = load(cosine.v + k);
    return hn::MulAdd(load(sine.v + k), horner<kNumber>(q, x), horner<kNumber + 1>(p, x));
  });
}

/// Any number of harmonics, by rotation.
inline HWY_NOINLINE void evaluate_harmonics(const Series& series, const double* c, const Lane& cosine, const Lane& sine,
                                            std::size_t end, bool add, Lane& out) {
  for_vectors(end, add, out, [&](std::size_t k) HWY_ATTR {
    const SineCosine one{load(sine.v + k), load(cosine.v + k)};
    SineCosine harmonic = one;
    Vector value = set(c[0]);
    for (std::size_t h = 1; h <= series.size; ++h) {
      value = hn::MulAdd(set(c[2 * h - 1]), harmonic.cosine, value);
      value = hn::MulAdd(set(c[2 * h]), harmonic.sine, value);
      turn(one, harmonic.cosine, harmonic.sine);
    }
    return value;
  });
}

/// All series of a group of harmonics over the block.
inline HWY_NOINLINE void evaluate_fourier(const FunctionGroup& group, const double* numbers, const AxisLanes& lanes,
                                          std::size_t end, unsigned written, Lane* out) {
  Lane own[2];
  if (!group.shares_turn) {
    for (std::size_t k = 0; k < end; k += hn::Lanes(Tag())) {
      const SineCosine one = fourier_argument(group.scale, false, lanes, k);
      store(one.cosine, own[0].v + k);
      store(one.sine, own[1].v + k);
    }
  }
  const Lane& cosine = group.shares_turn ? lanes.cosine : own[0];
  const Lane& sine = group.shares_turn ? lanes.sine : own[1];
  for (const Series& series : group.series) {
    const bool add = (written >> series.component & 1) != 0;
    Lane& to = out[series.component];
    if (series.size == 0 || series.size > kMostHarmonicPowers) {
      evaluate_harmonics(series, numbers + series.first, cosine, sine, end, add, to);
    } else {
      with_constant<kMostHarmonicPowers>(series.size, [&](auto number) HWY_ATTR {
        evaluate_harmonic_powers<number()>(numbers + series.powers, cosine, sine, end, add, to);
      });
    }
    written |= 1u << series.component;
  }
}

inline HWY_NOINLINE void evaluate_pieces(const FunctionGroup& group, const double* numbers, const AxisLanes& lanes,
                                         std::size_t k, unsigned written, Lane* out) {
  const Tag d;
  const IndexTag di;
  const Piece piece = find_piece(group, numbers, load(lanes.position.v + k));
  const auto at = hn::ShiftLeft<2>(whole_index(piece.index));
  for (const Series& series : group.series) {
    const double* c = numbers + series.first;
    Vector value = hn::GatherIndex(d, c, hn::Add(at, hn::Set(di, 1)));
    if (!group.straight) {
      value = hn::MulAdd(hn::GatherIndex(d, c, hn::Add(at, hn::Set(di, 2))), piece.local, value);
      const Vector cube = hn::Mul(hn::GatherIndex(d, c, hn::Add(at, hn::Set(di, 3))), piece.local);
      value = hn::MulAdd(cube, piece.local, value);
    }
    value = hn::MulAdd(value, piece.local, hn::GatherIndex(d, c, at));
    add_to(out[series.component].v + k, (written >> series.component & 1) != 0, value);
    written |= 1u << series.component;
  }
}

/// All series of one group over the block.
HWY_INLINE void evaluate_group(const FunctionGroup& group, const double* numbers, const AxisLanes& lanes,
                               std::size_t end, unsigned written, Lane* out) {
  if (group.form == Form::pieces) {
    for (std::size_t k = 0; k < end; k += hn::Lanes(Tag())) evaluate_pieces(group, numbers, lanes, k, written, out);
  } else if (group.form == Form::fourier) {
    evaluate_fourier(group, numbers, lanes, end, written, out);
  } else {
    evaluate_polynomials(group, numbers, lanes, end, written, out);
  }
}

/// Adds the terms of a step that have states.
/// @param factor  [states of the chain]
inline HWY_NOINLINE void add_stated_errors(const CompiledChain& chain, const AxisStep& step, const Lane* factor,
                                           std::size_t end, AxisLanes& lanes) {
  Lane value[6];
  for (std::size_t g = step.plain_groups; g < step.groups.size(); ++g) {
    const FunctionGroup& group = step.groups[g];
    evaluate_group(group, chain.numbers.data(), lanes, end, 0, value);
    const double* by = factor[group.state].v;
    for (const Series& series : group.series) {
      double* sum = lanes.error[series.component].v;
      const double* added = value[series.component].v;
      for (std::size_t k = 0; k < end; k += hn::Lanes(Tag())) {
        store(hn::MulAdd(load(added + k), load(by + k), load(sum + k)), sum + k);
      }
    }
  }
}

/// Reads the commands of a step's axis and evaluates its error motions into lanes.error.
/// @param factor  of the states of the chain; null if it has none
inline HWY_NOINLINE void evaluate_axis(const CompiledChain& chain, const AxisStep& step, const double* commands,
                                       std::size_t count, AxisLanes& lanes, const Lane* factor) {
  const std::size_t width = hn::Lanes(Tag()), end = whole_vectors(count);
  if (step.rotary) {
    const auto keep = [&](Vector q, const SineCosine& turn_of_axis, std::size_t k) HWY_ATTR {
      store(q, lanes.position.v + k);
      store(turn_of_axis.sine, lanes.sine.v + k);
      store(turn_of_axis.cosine, lanes.cosine.v + k);
    };
    std::size_t k = 0;
    for (; k + 2 * width <= count; k += 2 * width) {
      const Vector q[2] = {hn::LoadU(Tag(), commands + k), hn::LoadU(Tag(), commands + k + width)};
      SineCosine turns[2];
      sines_cosines<2>(q, turns);
      keep(q[0], turns[0], k);
      keep(q[1], turns[1], k + width);
    }
    for (; k < end; k += width) {
      const Vector q = read(commands, k, count);
      keep(q, sine_cosine(q), k);
    }
  } else {
    read_lane(commands, count, lanes.position);
  }
  if (!step.has_errors) return;
  unsigned written = 0;
  for (std::size_t g = 0; g < step.plain_groups; ++g) {
    const FunctionGroup& group = step.groups[g];
    evaluate_group(group, chain.numbers.data(), lanes, end, written, lanes.error);
    for (const Series& series : group.series) written |= 1u << series.component;
  }
  for (int component = 0; component < 6; ++component) {
    if ((written >> component & 1) != 0) continue;
    for (std::size_t k = 0; k < end; k += width) store(hn::Zero(Tag()), lanes.error[component].v + k);
  }
  if (step.plain_groups < step.groups.size()) add_stated_errors(chain, step, factor, end, lanes);
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe::chain
HWY_AFTER_NAMESPACE();

#endif  // per target
