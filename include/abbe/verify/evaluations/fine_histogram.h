#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "abbe/verify/evaluations/statistics.h"

namespace abbe {

/// A value that is known within a bound.
struct BoundedValue {
  double value = 0;
  double bound = 0;  ///< the exact value is no farther away
};

/// Counts of values in classes so fine that percentiles follow from them: 16384 classes of equal width from each power
/// of two to the next, on both sides of zero. The width of a class is at most 1/16384 of its values; values below
/// kSmallest share one class. Its memory does not depend on the number of values.
class FineHistogram {
 public:
  static constexpr double kSmallest = 0x1p-27;  ///< mm: 7.5e-9
  static constexpr double kLargest = 0x1p40;    ///< larger amounts count as this

  FineHistogram();
  /// Class of a finite value, for add().
  static std::uint32_t class_of(double value);
  void add(std::uint32_t number) { ++counts_[number]; }
  /// @throws std::invalid_argument for a class that does not exist
  void add(std::uint32_t number, std::uint64_t count);

  std::uint64_t count() const;
  /// Percentile as percentile() has it. @param fraction  0..1 @return zeros if there are no values
  BoundedValue percentile(double fraction) const;
  /// The same for the amounts.
  BoundedValue percentile_of_amounts(double fraction) const;
  /// Classes as histogram() has them; every fine class counts where its middle is.
  Histogram classes(double from, double to, std::size_t classes) const;

  /// Numbers and counts of the classes that have any.
  std::vector<std::pair<std::uint32_t, std::uint64_t>> occupied() const;

 private:
  std::vector<std::uint64_t> counts_;  ///< ascending values
};

}  // namespace abbe
