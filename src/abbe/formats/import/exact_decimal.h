#pragma once

// Internal to formats: decimal numbers with all their digits, for conversions that are exact in decimal.
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace abbe {

/// A decimal number of any length.
class ExactDecimal {
 public:
  /// Of a number as Abbe reads it: "-12.50", "1e-3". @returns nothing for any other text, for exponents
  /// beyond 60 and for more than 1000 digits
  static std::optional<ExactDecimal> of(std::string_view text);

  void multiply(std::uint32_t factor);
  /// Times 10^shift.
  void shift(int shift) { exponent_ += shift; }
  void negate() { negative_ = !negative_; }
  void add(const ExactDecimal& other);
  /// Without an exponent; digits behind the point stay, also zeros. Zero has no sign.
  std::string text() const;

 private:
  void align(int exponent);
  bool is_negative() const;  // zero is not

  bool negative_ = false;
  std::string digits_;  ///< of a whole number, which may begin with zeros
  int exponent_ = 0;    ///< value = digits * 10^exponent
};

}  // namespace abbe
