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

/// A'B of two tall blocks, added to sums[i + j * sums_stride], i a column of A, j of B. Padding as above, but
/// `b_count` is a multiple of 2.
void add_cross_products(const double* a, std::size_t a_count, std::size_t a_stride, const double* b,
                        std::size_t b_count, std::size_t b_stride, std::size_t length, double* sums,
                        std::size_t sums_stride);

/// Products of columns, element by element, with the rows of one reading added up: for columns a[i], begin <= i < end,
/// and b[j], one column after the other,
///
///     out[k] = sum over r of a[i][r * count + k] b[j][r * count + k],   k < count
///
/// j runs over all of b first, or with `triangle` from i on (a and b are then the same). Whole vectors are read and
/// written: every column can be read for kLengthMultiple numbers after its last one, and what is written from k = count
/// up to the next multiple means nothing.
/// @param b    [b_count] columns of [rows * count]
/// @param out  columns out_stride apart
void fold_products(const double* const* a, std::size_t begin, std::size_t end, const double* const* b,
                   std::size_t b_count, bool triangle, std::size_t rows, std::size_t count, double* out,
                   std::size_t out_stride);

/// Name of the vector instructions that these functions use on this processor: "AVX2", "NEON".
const char* vector_instructions();

}  // namespace abbe
