#include "abbe/verify/evaluations/exact_sum.h"

#include <bit>
#include <cmath>
#include <cstdint>

namespace abbe {
namespace {

constexpr int kLimbBits = 32;
/// Power of two of the lowest bit of all.
constexpr int kLowestPower = -304;

}  // namespace

void ExactSum::add(double value) {
  const auto bits = std::bit_cast<std::uint64_t>(value);
  // 53 bits, the lowest of them at 2^power.
  const int power = static_cast<int>(bits >> 52U & 0x7ffU) - 1075;
  if (power < kLowestPower) return;
  const auto place = static_cast<unsigned>(power - kLowestPower);
  const Wide whole = static_cast<Wide>((bits & 0xfffffffffffffULL) | 0x10000000000000ULL) << (place % kLimbBits);
  limbs_[place / kLimbBits] += bits >> 63U != 0 ? -whole : whole;
}

void ExactSum::add_square(double value) {
  const double square = value * value;
  add(square);
  add(std::fma(value, value, -square));
}

void ExactSum::add(const ExactSum& other) {
  for (std::size_t i = 0; i < kLimbs; ++i) limbs_[i] += other.limbs_[i];
}

long double ExactSum::value() const {
  std::array<Wide, kLimbs> digits = limbs_;
  const auto carry = [&] {
    for (std::size_t i = 0; i + 1 < kLimbs; ++i) {
      const Wide over = digits[i] >> kLimbBits;
      digits[i] -= over << kLimbBits;
      digits[i + 1] += over;
    }
  };
  carry();
  // The digits of an amount: those of a negative number would cancel.
  const bool negative = digits.back() < 0;
  if (negative) {
    for (Wide& digit : digits) digit = -digit;
    carry();
  }
  long double sum = 0;
  for (std::size_t i = kLimbs; i-- > 0;) {
    sum += std::ldexp(static_cast<long double>(digits[i]), kLowestPower + kLimbBits * static_cast<int>(i));
  }
  return negative ? -sum : sum;
}

}  // namespace abbe
