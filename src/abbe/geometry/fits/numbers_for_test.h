#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

namespace abbe::test {

/// Reproducible numbers for tests, the same with every standard library.
class Numbers {
 public:
  explicit Numbers(std::uint64_t seed) : generator_(seed) {}
  double uniform(double from = 0, double to = 1) {
    return from + (to - from) * static_cast<double>(generator_() >> 11U) * 0x1p-53;
  }
  double normal() {
    const double radius = std::sqrt(-2 * std::log(1 - uniform()));
    return radius * std::cos(2 * std::numbers::pi * uniform());
  }
  Eigen::Vector3d normal3() {
    const double x = normal(), y = normal();
    return {x, y, normal()};
  }
  Eigen::Vector3d direction() { return Eigen::Vector3d(normal(), normal(), normal()).normalized(); }
  std::size_t below(std::size_t bound) { return generator_() % bound; }
  std::uint64_t bits() { return generator_(); }

 private:
  std::mt19937_64 generator_;
};

}  // namespace abbe::test
