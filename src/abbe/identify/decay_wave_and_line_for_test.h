#pragma once

#include <complex>
#include <cstddef>
#include <vector>

namespace abbe::test {

/// Three rows per reading: a decay, an oscillation and a line.
inline std::complex<double> decay_wave_and_line(double t, std::size_t row, const std::vector<std::complex<double>>& b) {
  if (row == 0) return b[0] * std::exp(-b[1] * t) + b[2];
  if (row == 1) return b[3] * std::sin(b[4] * t);
  return b[5] + b[6] * t;
}

/// True parameters of it.
inline const std::vector<double> kDecayWaveAndLine = {3, 0.4, 1, 2, 1.3, -1, 0.5};

}  // namespace abbe::test
