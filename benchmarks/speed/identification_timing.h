#pragma once

#include <chrono>
#include <cstdio>

#include "abbe/identify/identify.h"

namespace abbe::benchmarks {

inline constexpr int kThreads = 2;

inline double seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// The tolerances that Ceres gets too: ceres_options().
inline IdentifyOptions our_options() {
  IdentifyOptions options;
  options.solver.threads = kThreads;
  options.solver.relative_cost = 1e-12;
  return options;
}

/// One line of the result.
inline bool check(const char* what, double value, bool good) {
  std::printf("  %-58s %10.3g  %s\n", what, value, good ? "reached" : "MISSED");
  return good;
}

}  // namespace abbe::benchmarks
