#pragma once

#include <cstddef>

namespace abbe {

/// Columns and column lengths of the arrays below are padded to these multiples, with zeros.
inline constexpr std::size_t kColumnMultiple = 4;
inline constexpr std::size_t kLengthMultiple = 8;

inline constexpr std::size_t padded(std::size_t count, std::size_t multiple) {
  return (count + multiple - 1) / multiple * multiple;
}

/// A'A of a tall block, added to the lower triangle of a square array: sums[i + j * sums_stride] for i >= j.
///
/// Vectorised with run-time dispatch; the sums of one call depend on the processor's vector length, not on threads.
/// @param columns  a[column * stride + k], k < length; count a multiple of kColumnMultiple, length and stride of
///                 kLengthMultiple
/// @param sums     [count, count]; entries just above the diagonal (within tiles of 4) are used as scratch
void add_self_products(const double* a, std::size_t count, std::size_t stride, std::size_t length, double* sums,
                       std::size_t sums_stride);

/// A'B of two tall blocks, added to sums[i + j * sums_stride], i a column of A, j of B. Padding as above.
void add_cross_products(const double* a, std::size_t a_count, std::size_t a_stride, const double* b,
                        std::size_t b_count, std::size_t b_stride, std::size_t length, double* sums,
                        std::size_t sums_stride);

/// Name of the vector instructions that these functions use on this processor: "AVX2", "NEON".
const char* vector_instructions();

}  // namespace abbe
