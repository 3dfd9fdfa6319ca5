#pragma once

#include <limits>

namespace abbe {

/// A number that a user may state about a test.
template <class Test>
struct TestNumber {
  const char* option;   ///< of `abbe evaluate`: "--u-reading-um"
  double Test::*value;  ///< not a number: not stated
  double unit;          ///< of the option's value
  double from, to;      ///< range of the option's value
  const char* words;    ///< what it is
};

/// A number that has not been stated.
inline constexpr double kNotStated = std::numeric_limits<double>::quiet_NaN();

}  // namespace abbe
