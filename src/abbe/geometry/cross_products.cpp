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

HWY_INLINE double sum_of(Vector v) { return hn::GetLane(hn::SumOfLanes(Lanes(), v)); }

// Inner products of four columns of a with kTileWidth columns of b.
HWY_INLINE void add_tile(const double* HWY_RESTRICT a, std::size_t a_stride, const double* HWY_RESTRICT b,
                         std::size_t b_stride, std::size_t length, double* HWY_RESTRICT sums, std::size_t sums_stride) {
  const Lanes d;
  const std::size_t lanes = hn::Lanes(d);
  const double *a0 = a, *a1 = a + a_stride, *a2 = a + 2 * a_stride, *a3 = a + 3 * a_stride;
  const double *b0 = b, *b1 = b + b_stride;
  Vector s00 = hn::Zero(d), s10 = s00, s20 = s00, s30 = s00, s01 = s00, s11 = s00, s21 = s00, s31 = s00;
#if HWY_TARGET <= HWY_AVX3 || HWY_ARCH_ARM_A64
  const double *b2 = b + 2 * b_stride, *b3 = b + 3 * b_stride;
  Vector s02 = s00, s12 = s00, s22 = s00, s32 = s00, s03 = s00, s13 = s00, s23 = s00, s33 = s00;
#endif
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
#if HWY_TARGET <= HWY_AVX3 || HWY_ARCH_ARM_A64
    const Vector w2 = hn::LoadU(d, b2 + k), w3 = hn::LoadU(d, b3 + k);
    s02 = hn::MulAdd(v0, w2, s02);
    s12 = hn::MulAdd(v1, w2, s12);
    s22 = hn::MulAdd(v2, w2, s22);
    s32 = hn::MulAdd(v3, w2, s32);
    s03 = hn::MulAdd(v0, w3, s03);
    s13 = hn::MulAdd(v1, w3, s13);
    s23 = hn::MulAdd(v2, w3, s23);
    s33 = hn::MulAdd(v3, w3, s33);
#endif
  }
  const auto add = [&](std::size_t j, Vector t0, Vector t1, Vector t2, Vector t3) {
    double* column = sums + j * sums_stride;
    column[0] += sum_of(t0);
    column[1] += sum_of(t1);
    column[2] += sum_of(t2);
    column[3] += sum_of(t3);
  };
  add(0, s00, s10, s20, s30);
  add(1, s01, s11, s21, s31);
#if HWY_TARGET <= HWY_AVX3 || HWY_ARCH_ARM_A64
  add(2, s02, s12, s22, s32);
  add(3, s03, s13, s23, s33);
#endif
}

void add_self_products_here(const double* a, std::size_t count, std::size_t stride, std::size_t length, double* sums,
                            std::size_t sums_stride) {
  for (std::size_t i = 0; i < count; i += 4)
    for (std::size_t j = 0; j < i + 4; j += kTileWidth)
      add_tile(a + i * stride, stride, a + j * stride, stride, length, sums + i + j * sums_stride, sums_stride);
}

void add_cross_products_here(const double* a, std::size_t a_count, std::size_t a_stride, const double* b,
                             std::size_t b_count, std::size_t b_stride, std::size_t length, double* sums,
                             std::size_t sums_stride) {
  // Pieces short enough for four columns of each side to stay in the first-level cache.
  constexpr std::size_t kPiece = 512;
  for (std::size_t start = 0; start < length; start += kPiece) {
    const std::size_t piece = length - start < kPiece ? length - start : kPiece;
    for (std::size_t i = 0; i < a_count; i += 4)
      for (std::size_t j = 0; j < b_count; j += kTileWidth)
        add_tile(a + i * a_stride + start, a_stride, b + j * b_stride + start, b_stride, piece,
                 sums + i + j * sums_stride, sums_stride);
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

const char* vector_instructions() { return HWY_DYNAMIC_DISPATCH(vector_instructions_here)(); }

}  // namespace abbe
#endif
