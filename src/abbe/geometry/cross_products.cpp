#include "abbe/geometry/cross_products.h"

// Vector types without a fixed size cannot stand in the arrays of a tile.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "abbe/geometry/cross_products.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Lanes = hn::CappedTag<double, 8>;
using Vector = hn::Vec<Lanes>;

// Sixteen sums need 32 registers; with 16 registers eight sums are the most that stay out of memory.
#if HWY_TARGET <= HWY_AVX3 || HWY_ARCH_ARM_A64
constexpr std::size_t kTileWidth = 4;
#else
constexpr std::size_t kTileWidth = 2;
#endif

/// Adds the sums of the lanes of four vectors to four numbers.
HWY_INLINE void add_sums(Vector v0, Vector v1, Vector v2, Vector v3, double* HWY_RESTRICT sums) {
  const Lanes d;
#if HWY_TARGET == HWY_AVX2 || HWY_TARGET <= HWY_AVX3
  const Vector v01 = hn::Add(hn::InterleaveLower(d, v0, v1), hn::InterleaveUpper(d, v0, v1));
  const Vector v23 = hn::Add(hn::InterleaveLower(d, v2, v3), hn::InterleaveUpper(d, v2, v3));
  const Vector halves = hn::Add(hn::ConcatLowerLower(d, v23, v01), hn::ConcatUpperUpper(d, v23, v01));
#if HWY_TARGET == HWY_AVX2
  hn::StoreU(hn::Add(hn::LoadU(d, sums), halves), d, sums);
#else
  const hn::Half<Lanes> four;
  const auto low = hn::LowerHalf(four, halves), high = hn::UpperHalf(four, halves);
  const auto all = hn::Add(hn::ConcatLowerLower(four, high, low), hn::ConcatUpperUpper(four, high, low));
  hn::StoreU(hn::Add(hn::LoadU(four, sums), all), four, sums);
#endif
#else
  sums[0] += hn::GetLane(hn::SumOfLanes(d, v0));
  sums[1] += hn::GetLane(hn::SumOfLanes(d, v1));
  sums[2] += hn::GetLane(hn::SumOfLanes(d, v2));
  sums[3] += hn::GetLane(hn::SumOfLanes(d, v3));
#endif
}

// Inner products of four columns of a with kWidth columns of b.
template <std::size_t kWidth>
HWY_INLINE void add_tile(const double* HWY_RESTRICT a, std::size_t a_stride, const double* HWY_RESTRICT b,
                         std::size_t b_stride, std::size_t length, double* HWY_RESTRICT sums, std::size_t sums_stride) {
  static_assert(kWidth == 2 || kWidth == 4);
  const Lanes d;
  const std::size_t lanes = hn::Lanes(d);
  const double *a0 = a, *a1 = a + a_stride, *a2 = a + 2 * a_stride, *a3 = a + 3 * a_stride;
  const double *b0 = b, *b1 = b + b_stride;
  const double *b2 = b + (kWidth - 2) * b_stride, *b3 = b + (kWidth - 1) * b_stride;
  Vector s00 = hn::Zero(d), s10 = s00, s20 = s00, s30 = s00, s01 = s00, s11 = s00, s21 = s00, s31 = s00;
  Vector s02 = s00, s12 = s00, s22 = s00, s32 = s00, s03 = s00, s13 = s00, s23 = s00, s33 = s00;
  for (std::size_t k = 0; k < length; k += lanes) {
    const Vector v0 = hn::LoadU(d, a0 + k), v1 = hn::LoadU(d, a1 + k);
    const Vector v2 = hn::LoadU(d, a2 + k), v3 = hn::LoadU(d, a3 + k);
    const Vector w0 = hn::LoadU(d, b0 + k), w1 = hn::LoadU(d, b1 + k);
    s00 = hn::MulAdd(v0, w0, s00);
    s10 = hn::MulAdd(v1, w0, s10);
    s20 = hn::MulAdd(v2, w0, s20);
    s30 = hn::MulAdd(v3, w0, s30);
    s01 = hn::MulAdd(v0, w1, s01);
    s11 = hn::MulAdd(v1, w1, s11);
    s21 = hn::MulAdd(v2, w1, s21);
    s31 = hn::MulAdd(v3, w1, s31);
    if constexpr (kWidth == 4) {
      const Vector w2 = hn::LoadU(d, b2 + k), w3 = hn::LoadU(d, b3 + k);
      s02 = hn::MulAdd(v0, w2, s02);
      s12 = hn::MulAdd(v1, w2, s12);
      s22 = hn::MulAdd(v2, w2, s22);
      s32 = hn::MulAdd(v3, w2, s32);
      s03 = hn::MulAdd(v0, w3, s03);
      s13 = hn::MulAdd(v1, w3, s13);
      s23 = hn::MulAdd(v2, w3, s23);
      s33 = hn::MulAdd(v3, w3, s33);
    }
  }
  add_sums(s00, s10, s20, s30, sums);
  add_sums(s01, s11, s21, s31, sums + sums_stride);
  if constexpr (kWidth == 4) {
    add_sums(s02, s12, s22, s32, sums + 2 * sums_stride);
    add_sums(s03, s13, s23, s33, sums + 3 * sums_stride);
  }
}

void add_self_products_here(const double* a, std::size_t count, std::size_t stride, std::size_t length, double* sums,
                            std::size_t sums_stride) {
  for (std::size_t i = 0; i < count; i += 4)
    for (std::size_t j = 0; j < i + 4; j += kTileWidth)
      add_tile<kTileWidth>(a + i * stride, stride, a + j * stride, stride, length, sums + i + j * sums_stride,
                           sums_stride);
}

void add_cross_products_here(const double* a, std::size_t a_count, std::size_t a_stride, const double* b,
                             std::size_t b_count, std::size_t b_stride, std::size_t length, double* sums,
                             std::size_t sums_stride) {
  // Pieces short enough for four columns of each side to stay in the first-level cache.
  constexpr std::size_t kPiece = 512;
  for (std::size_t start = 0; start < length; start += kPiece) {
    const std::size_t piece = length - start < kPiece ? length - start : kPiece;
    for (std::size_t i = 0; i < a_count; i += 4) {
      const double* left = a + i * a_stride + start;
      double* out = sums + i;
      std::size_t j = 0;
      for (; j + kTileWidth <= b_count; j += kTileWidth)
        add_tile<kTileWidth>(left, a_stride, b + j * b_stride + start, b_stride, piece, out + j * sums_stride,
                             sums_stride);
      if (j < b_count)
        add_tile<2>(left, a_stride, b + j * b_stride + start, b_stride, piece, out + j * sums_stride, sums_stride);
    }
  }
}

/// Readings of [count] that are folded together.
struct Fold {
  std::size_t rows, count;
  std::size_t from, to;
};

/// Products of kA columns with kB others, rows added up; out[i][j * out_stride + k].
template <std::size_t kA, std::size_t kB>
HWY_INLINE void fold_tile(const double* const* a, const double* const* b, const Fold& fold, double* const* out,
                          std::size_t out_stride) {
  static_assert(kA <= 2 && kB <= 4);
  const Lanes d;
  const std::size_t lanes = hn::Lanes(d);
  const double *a0 = a[0], *a1 = a[kA - 1];
  const double *b0 = b[0], *b1 = b[kB > 1 ? 1 : 0], *b2 = b[kB > 2 ? 2 : 0], *b3 = b[kB > 3 ? 3 : 0];
  double *out0 = out[0], *out1 = out[kA - 1];
  const std::size_t rows = fold.rows, count = fold.count, to = fold.to;
  for (std::size_t k = fold.from; k < to; k += lanes) {
    Vector s00 = hn::Zero(d), s01 = s00, s02 = s00, s03 = s00, s10 = s00, s11 = s00, s12 = s00, s13 = s00;
    for (std::size_t row = 0, at = k; row < rows; ++row, at += count) {
      const Vector v0 = hn::LoadU(d, a0 + at), v1 = hn::LoadU(d, a1 + at);
      const Vector w0 = hn::LoadU(d, b0 + at);
      s00 = hn::MulAdd(v0, w0, s00);
      if constexpr (kA > 1) s10 = hn::MulAdd(v1, w0, s10);
      if constexpr (kB > 1) {
        const Vector w1 = hn::LoadU(d, b1 + at);
        s01 = hn::MulAdd(v0, w1, s01);
        if constexpr (kA > 1) s11 = hn::MulAdd(v1, w1, s11);
      }
      if constexpr (kB > 2) {
        const Vector w2 = hn::LoadU(d, b2 + at);
        s02 = hn::MulAdd(v0, w2, s02);
        if constexpr (kA > 1) s12 = hn::MulAdd(v1, w2, s12);
      }
      if constexpr (kB > 3) {
        const Vector w3 = hn::LoadU(d, b3 + at);
        s03 = hn::MulAdd(v0, w3, s03);
        if constexpr (kA > 1) s13 = hn::MulAdd(v1, w3, s13);
      }
    }
    hn::StoreU(s00, d, out0 + k);
    if constexpr (kB > 1) hn::StoreU(s01, d, out0 + out_stride + k);
    if constexpr (kB > 2) hn::StoreU(s02, d, out0 + 2 * out_stride + k);
    if constexpr (kB > 3) hn::StoreU(s03, d, out0 + 3 * out_stride + k);
    if constexpr (kA > 1) {
      hn::StoreU(s10, d, out1 + k);
      if constexpr (kB > 1) hn::StoreU(s11, d, out1 + out_stride + k);
      if constexpr (kB > 2) hn::StoreU(s12, d, out1 + 2 * out_stride + k);
      if constexpr (kB > 3) hn::StoreU(s13, d, out1 + 3 * out_stride + k);
    }
  }
}

template <std::size_t kA>
HWY_INLINE void fold_row(const double* const* a, const double* const* b, std::size_t b_count, const Fold& fold,
                         double* out0, double* out1, std::size_t out_stride) {
  std::size_t j = 0;
  double* out[2] = {out0, out1};
  for (; j + 4 <= b_count; j += 4) {
    fold_tile<kA, 4>(a, b + j, fold, out, out_stride);
    out[0] += 4 * out_stride;
    out[1] += 4 * out_stride;
  }
  if (b_count - j == 3) fold_tile<kA, 3>(a, b + j, fold, out, out_stride);
  if (b_count - j == 2) fold_tile<kA, 2>(a, b + j, fold, out, out_stride);
  if (b_count - j == 1) fold_tile<kA, 1>(a, b + j, fold, out, out_stride);
}

void fold_products_here(const double* const* a, std::size_t begin, std::size_t end, const double* const* b,
                        std::size_t b_count, bool triangle, std::size_t rows, std::size_t count, double* out,
                        std::size_t out_stride) {
  // So few at a time that rows of the columns of both sides stay in the first-level cache.
  constexpr std::size_t kReadings = 64;
  for (std::size_t from = 0; from < count; from += kReadings) {
    const Fold fold{rows, count, from, count - from < kReadings ? count : from + kReadings};
    double* column = out;
    std::size_t i = begin;
    for (; i + 2 <= end; i += 2) {
      const std::size_t first = triangle ? i : 0, number = b_count - first;
      double* next = column + number * out_stride;
      if (triangle) {
        fold_row<1>(a + i, b + i, 1, fold, column, column, out_stride);
        fold_row<2>(a + i, b + i + 1, number - 1, fold, column + out_stride, next, out_stride);
      } else {
        fold_row<2>(a + i, b, number, fold, column, next, out_stride);
      }
      column = next + (number - (triangle ? 1 : 0)) * out_stride;
    }
    const std::size_t first = triangle ? i : 0;
    if (i < end) fold_row<1>(a + i, b + first, b_count - first, fold, column, column, out_stride);
  }
}

const char* vector_instructions_here() { return hwy::TargetName(HWY_TARGET); }

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace abbe {

HWY_EXPORT(add_self_products_here);
HWY_EXPORT(add_cross_products_here);
HWY_EXPORT(fold_products_here);
HWY_EXPORT(vector_instructions_here);

void add_self_products(const double* a, std::size_t count, std::size_t stride, std::size_t length, double* sums,
                       std::size_t sums_stride) {
  HWY_DYNAMIC_DISPATCH(add_self_products_here)(a, count, stride, length, sums, sums_stride);
}

void add_cross_products(const double* a, std::size_t a_count, std::size_t a_stride, const double* b,
                        std::size_t b_count, std::size_t b_stride, std::size_t length, double* sums,
                        std::size_t sums_stride) {
  HWY_DYNAMIC_DISPATCH(add_cross_products_here)(a, a_count, a_stride, b, b_count, b_stride, length, sums, sums_stride);
}

void fold_products(const double* const* a, std::size_t begin, std::size_t end, const double* const* b,
                   std::size_t b_count, bool triangle, std::size_t rows, std::size_t count, double* out,
                   std::size_t out_stride) {
  HWY_DYNAMIC_DISPATCH(fold_products_here)(a, begin, end, b, b_count, triangle, rows, count, out, out_stride);
}

const char* vector_instructions() { return HWY_DYNAMIC_DISPATCH(vector_instructions_here)(); }

}  // namespace abbe
#endif
