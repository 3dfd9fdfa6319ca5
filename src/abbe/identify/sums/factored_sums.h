#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "abbe/errors/factored_columns.h"
#include "abbe/identify/sums/carrier_groups.h"

namespace abbe {

/// Products of the columns of a Jacobian from their factors, without the columns.
///
/// With columns g_c phi_k and g_d phi_l (FactoredColumns) the sum over rows r and readings n is
///
///     sum_rn g_c,rn phi_k,n g_d,rn phi_l,n = sum_n W_cd,n P_kl,n,   W_cd,n = sum_r g_c,rn g_d,rn,  P_kl = phi_k phi_l
///
/// so that rows are added up once for each pair of carriers, and all products of two groups of columns (carriers that
/// have the same basis functions) are one product of two blocks of columns W and P of one number per reading. The
/// residuals are one more carrier with the basis function 1.
class FactoredSums {
 public:
  /// @param rows  of a reading
  FactoredSums(FactoredColumns form, std::size_t rows);

  const FactoredColumns& form() const { return form_; }
  /// True if this takes less time than the products of whole columns. Depends on the layout alone.
  bool is_quicker() const { return quicker_; }

  /// Numbers of working memory for add().
  std::size_t scratch_size() const { return (scratch_w_ + scratch_p_) * kStride; }
  std::size_t sums_size(bool normal) const { return normal ? normal_.size : gradient_.size; }

  /// Adds what one block of readings contributes; weights are in the carriers. Readings that are left out are 0.
  /// @param carriers  form().carriers() columns, then the residuals, column * stride + row * count + k; can be read for
  ///                  kLengthMultiple numbers after the last column
  /// @param bases     form().bases() columns, then 1 for readings that count, column * kStride + k; 0 from count on
  /// @param sums      [sums_size(normal)]
  void add(bool normal, const double* carriers, std::size_t stride, const double* bases, std::size_t count,
           double* scratch, double* sums) const;

  /// Appends the gradient, and the lower triangle of the normal matrix column by column, to `values`.
  void append(bool normal, const std::vector<double>& sums, std::vector<double>& values) const;

  /// Length of a column of one number per reading.
  static constexpr std::size_t kStride = 128;

 private:
  /// Products of some carriers of one group with all of another one.
  struct Part {
    std::size_t a = 0, b = 0;        ///< groups, a <= b
    std::size_t begin = 0, end = 0;  ///< carriers of a
    std::size_t w = 0, p = 0;        ///< pairs of carriers; of basis functions
    std::size_t offset = 0;          ///< of sums[w + p * padded(w)]
  };
  struct Layout {
    std::vector<Part> parts;
    std::vector<std::size_t> first_part;  ///< [a * groups + b]
    std::size_t size = 0;
    std::vector<std::uint32_t> gradient, normal;  ///< where the sums of columns stand
  };
  /// Where a column, or the residuals, stands in the groups.
  struct Place {
    std::size_t group = 0, carrier = 0, basis = 0;
  };

  void add_parts(std::size_t a, std::size_t b, Layout& layout);
  std::uint32_t source(const Layout& layout, Place x, Place y) const;

  FactoredColumns form_;
  std::size_t rows_;
  std::vector<CarrierGroup> groups_;  ///< the last one: the residuals alone
  Layout normal_, gradient_;
  std::size_t scratch_w_ = 0, scratch_p_ = 0;
  bool quicker_ = false;
};

}  // namespace abbe
