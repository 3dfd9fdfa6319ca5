// Basis functions and slopes of error motions over a block of poses, for derivatives; compiled once per processor
// generation, after chain_kernel_inline.h.

#if defined(ABBE_ERRORS_CHAIN_KERNEL_SLOPES_INLINE_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_ERRORS_CHAIN_KERNEL_SLOPES_INLINE_H_
#undef ABBE_ERRORS_CHAIN_KERNEL_SLOPES_INLINE_H_
#else
#define ABBE_ERRORS_CHAIN_KERNEL_SLOPES_INLINE_H_
#endif

#include "abbe/errors/chain_kernel_inline.h"

HWY_BEFORE_NAMESPACE();
namespace abbe::chain {
namespace HWY_NAMESPACE {

/// Derivative of one series at one vector of poses, by the argument times `scale`.
HWY_INLINE Vector polynomial_slope(const Series& series, Form form, const double* c, Vector s) {
  // Power: Horner of sum n c_n s^(n-1). Chebyshev: Clenshaw of sum n c_n U_(n-1)(s).
  Vector value = hn::Zero(Tag()), before = hn::Zero(Tag());
  for (std::size_t n = series.size; n-- > 1;) {
    const Vector coefficient = set(static_cast<double>(n) * c[n]);
    if (form == Form::power) {
      value = hn::MulAdd(value, s, coefficient);
    } else {
      const Vector next = hn::MulAdd(hn::Add(s, s), value, hn::Sub(coefficient, before));
      before = value;
      value = next;
    }
  }
  return value;
}

HWY_INLINE Vector fourier_slope(const Series& series, const double* c, const SineCosine& one) {
  SineCosine harmonic = one;
  Vector value = hn::Zero(Tag());
  for (std::size_t h = 1; h <= series.size; ++h) {
    const double factor = static_cast<double>(h);
    value = hn::MulAdd(set(factor * c[2 * h]), harmonic.cosine, value);
    value = hn::NegMulAdd(set(factor * c[2 * h - 1]), harmonic.sine, value);
    turn(one, harmonic.cosine, harmonic.sine);
  }
  return value;
}

HWY_INLINE Vector piece_slope(const double* c, const Piece& piece) {
  const Tag d;
  const IndexTag di;
  const auto at = hn::ShiftLeft<2>(whole_index(piece.index));
  const Vector c1 = hn::GatherIndex(d, c, hn::Add(at, hn::Set(di, 1)));
  const Vector c2 = hn::GatherIndex(d, c, hn::Add(at, hn::Set(di, 2)));
  const Vector c3 = hn::GatherIndex(d, c, hn::Add(at, hn::Set(di, 3)));
  const Vector twice = hn::MulAdd(hn::Mul(set(3.0), c3), piece.local, hn::Add(c2, c2));
  return hn::Mul(hn::MulAdd(twice, piece.local, c1), piece.inverse_length);
}

/// d(EX .. EC)/d(command) of a step's axis at constant factors of states, per mm or rad.
/// @param factor  of the states of the chain; null if it has none
inline HWY_NOINLINE void evaluate_slopes(const CompiledChain& chain, const AxisStep& step, const AxisLanes& lanes,
                                         std::size_t end, const Lane* factor, Lane* slope) {
  const double* numbers = chain.numbers.data();
  for (std::size_t k = 0; k < end; k += hn::Lanes(Tag())) {
    for (int c = 0; c < 6; ++c) store(hn::Zero(Tag()), slope[c].v + k);
    for (const FunctionGroup& group : step.groups) {
      const Vector q = load(lanes.position.v + k);
      const Vector s = hn::Mul(hn::Sub(q, set(group.centre)), set(group.scale));
      SineCosine one{};
      Piece piece{};
      if (group.form == Form::fourier) one = fourier_argument(group.scale, group.shares_turn, lanes, k);
      if (group.form == Form::pieces) piece = find_piece(group, numbers, q);
      for (const Series& series : group.series) {
        const double* c = numbers + series.first;
        Vector value;
        if (group.form == Form::fourier) {
          value = hn::Mul(fourier_slope(series, c, one), set(group.scale));
        } else if (group.form == Form::pieces) {
          value = piece_slope(c, piece);
        } else {
          value = hn::Mul(polynomial_slope(series, group.form, c, s), set(group.scale));
        }
        if (series.gives_half()) value = hn::Add(value, value);
        if (group.state != kNoState) value = hn::Mul(value, load(factor[group.state].v + k));
        double* out = slope[series.component].v + k;
        store(hn::Add(load(out), value), out);
      }
    }
  }
}

/// Consecutive functions of a polynomial or Fourier basis: function[2 ...]; [0] and [1] are the two before them.
struct FunctionSequence {
  static constexpr std::size_t kNumber = 17;  // odd: a mean and whole pairs of a Fourier basis
  Lane function[2 + kNumber];
  Lane argument[2];  ///< s; or cosine, sine
};

/// Computes the functions from `first` on, which must be where the last call ended (0: begins).
/// @returns how many
inline HWY_NOINLINE std::size_t next_functions(const BasisUse& use, const AxisLanes& lanes, std::size_t end,
                                               std::size_t first, FunctionSequence& sequence) {
  const bool fourier = use.kind == BasisKind::fourier;
  const std::size_t most = first == 0 ? FunctionSequence::kNumber : FunctionSequence::kNumber - 1;
  const std::size_t number = std::min(most, use.size - first);
  Lane* f = sequence.function;
  for (std::size_t k = 0; k < end; k += hn::Lanes(Tag())) {
    if (first == 0) {
      if (fourier) {
        const SineCosine one = fourier_argument(use.scale, use.shares_turn, lanes, k);
        store(one.cosine, sequence.argument[0].v + k);
        store(one.sine, sequence.argument[1].v + k);
      } else {
        const Vector s = hn::Mul(hn::Sub(load(lanes.position.v + k), set(use.centre)), set(use.scale));
        store(s, sequence.argument[0].v + k);
      }
      store(set(1.0), f[2].v + k);
      store(set(0.0), f[1].v + k);
    } else {
      // The chunk before this one was full: `most` functions, one more if it was the first.
      const std::size_t last = first == FunctionSequence::kNumber ? most + 1 : most;
      store(load(f[last].v + k), f[0].v + k);
      store(load(f[last + 1].v + k), f[1].v + k);
    }
    const Vector a = load(sequence.argument[0].v + k);
    for (std::size_t i = first == 0 ? 1 : 0; i < number;) {
      const std::size_t n = first + i;
      const Vector before = load(f[i + 1].v + k);
      if (fourier) {
        SineCosine harmonic{load(sequence.argument[1].v + k), a};
        if (n > 1) {
          harmonic = {before, load(f[i].v + k)};
          turn(SineCosine{load(sequence.argument[1].v + k), a}, harmonic.cosine, harmonic.sine);
        }
        store(harmonic.cosine, f[2 + i].v + k);
        store(harmonic.sine, f[3 + i].v + k);
        i += 2;
        continue;
      }
      const double j = static_cast<double>(n);
      Vector next = hn::Mul(a, before);
      if (use.kind == BasisKind::legendre) {
        next = hn::NegMulAdd(set((j - 1) / j), load(f[i].v + k), hn::Mul(set((2 * j - 1) / j), next));
      } else if (use.kind == BasisKind::chebyshev && n > 1) {
        next = hn::Sub(hn::Add(next, next), load(f[i].v + k));
      }
      store(next, f[2 + i].v + k);
      ++i;
    }
  }
  return number;
}

/// The four functions of a piecewise basis that are not zero at each pose.
struct LocalFunctions {
  Lane number[4];  ///< which function, a whole number
  Lane value[4];
};

inline HWY_NOINLINE void find_local_functions(const FunctionGroup& group, const BasisUse& use, const double* numbers,
                                              const AxisLanes& lanes, std::size_t end, LocalFunctions& local) {
  const Tag d;
  const IndexTag di;
  const Vector size = set(static_cast<double>(use.size));
  for (std::size_t k = 0; k < end; k += hn::Lanes(d)) {
    const Piece piece = find_piece(group, numbers, load(lanes.position.v + k));
    const auto at = hn::ShiftLeft<4>(whole_index(piece.index));
    for (int j = 0; j < 4; ++j) {
      const double* w = numbers + use.weights + 4 * j;
      Vector value = hn::GatherIndex(d, w, hn::Add(at, hn::Set(di, 3)));
      value = hn::MulAdd(value, piece.local, hn::GatherIndex(d, w, hn::Add(at, hn::Set(di, 2))));
      value = hn::MulAdd(value, piece.local, hn::GatherIndex(d, w, hn::Add(at, hn::Set(di, 1))));
      value = hn::MulAdd(value, piece.local, hn::GatherIndex(d, w, at));
      store(value, local.value[j].v + k);
      const Vector number = hn::Add(piece.index, set(static_cast<double>(use.first_function + j)));
      store(hn::NegMulAdd(hn::Floor(hn::Div(number, size)), size, number), local.number[j].v + k);
    }
  }
}

inline HWY_NOINLINE void local_function(const LocalFunctions& local, double number, std::size_t end, Lane& out) {
  for (std::size_t k = 0; k < end; k += hn::Lanes(Tag())) {
    Vector sum = hn::Zero(Tag());
    for (int j = 0; j < 4; ++j) {
      const auto here = hn::Eq(load(local.number[j].v + k), set(number));
      sum = hn::Add(sum, hn::IfThenElseZero(here, load(local.value[j].v + k)));
    }
    store(sum, out.v + k);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe::chain
HWY_AFTER_NAMESPACE();

#endif  // per target
