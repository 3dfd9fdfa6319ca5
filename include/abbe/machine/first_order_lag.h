#pragma once

#include <cmath>

namespace abbe {

/// A value y behind a first-order lag of its input u: tau dy/dt + y = u. Every step is exact for an input that changes
/// in proportion to the time, however long the step is; nothing is allocated and nothing is thrown.
///
/// y - u obeys tau d/dt (y - u) + (y - u) = -tau du/dt, so that with x = step / tau
///   y(t + step) = u(t + step) + (y(t) - u(t)) exp(-x) - (u(t + step) - u(t)) (1 - exp(-x)) / x.
class FirstOrderLag {
 public:
  /// In equilibrium: as if the input had always been what it is. @param time_constant_s  above 0
  FirstOrderLag(double time_constant_s, double input) noexcept : FirstOrderLag(time_constant_s, input, input) {}
  FirstOrderLag(double time_constant_s, double input, double value) noexcept
      : time_constant_(time_constant_s), input_(input), value_(value) {}

  double time_constant_s() const noexcept { return time_constant_; }
  double input() const noexcept { return input_; }
  double value() const noexcept { return value_; }

  /// The value a time later, at which the input has become this.
  /// @param step_s  not below 0; 0: the input jumps, which leaves the value where it is
  double after(double step_s, double input) const noexcept {
    const double x = step_s / time_constant_;
    if (!(x > 0)) return value_;
    const double gone = -std::expm1(-x);
    return input + (value_ - input_) * (1 - gone) - (input - input_) * (gone / x);
  }

  /// Goes on by a time. @return the new value
  double advance(double step_s, double input) noexcept {
    value_ = after(step_s, input);
    input_ = input;
    return value_;
  }

 private:
  double time_constant_, input_, value_;
};

}  // namespace abbe
