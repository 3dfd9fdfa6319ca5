#pragma once

#include <array>
#include <cstddef>

namespace abbe {

/// Sum of many numbers without rounding: neither their order nor how they are grouped makes a difference.
///
/// Every number is a whole multiple of a power of two. Multiples are added as whole numbers of 128 bits, apart for each
/// 32 powers, as in Kulisch's long accumulator (U. Kulisch, Computer Arithmetic and Validity, 2nd edition 2013, 8).
/// Room is for 2^40 numbers. Amounts below 2^-250 count as zero.
class ExactSum {
 public:
  static constexpr double kLargest = 0x1p96;

  /// @param value  finite, of at most kLargest
  void add(double value);
  /// Adds the square, also without rounding. @param value  of at most 2^48
  void add_square(double value);
  void add(const ExactSum& other);
  /// Rounded once.
  long double value() const;

 private:
  __extension__ typedef __int128 Wide;
  static constexpr std::size_t kLimbs = 12;
  std::array<Wide, kLimbs> limbs_{};
};

}  // namespace abbe
