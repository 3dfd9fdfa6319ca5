#pragma once

#include <cstdint>

namespace abbe {

/// Reproducible random numbers: xoshiro256++ seeded by splitmix64 (Blackman and Vigna, ACM Trans. Math. Softw. 47
/// (2021) 36).
///
/// The same (seed, stream) gives the same numbers with every compiler, which std::normal_distribution does not promise.
/// Use one stream per independent piece of work, so that results do not depend on the number of threads.
class RandomStream {
 public:
  explicit RandomStream(std::uint64_t seed, std::uint64_t stream = 0);
  std::uint64_t bits();
  /// Uniform in [0, 1).
  double uniform();
  double uniform(double from, double to) { return from + (to - from) * uniform(); }
  /// Standard normal, by the polar method.
  double normal();

 private:
  std::uint64_t state_[4];
  double kept_ = 0;
  bool has_kept_ = false;
};

}  // namespace abbe
