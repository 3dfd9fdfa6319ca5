#include <algorithm>
#include <cmath>
#include <vector>

#include "abbe/geometry/parallel_blocks.h"
#include "abbe/identify/identify.h"

namespace abbe {
namespace {

/// @param evaluate  (first, size, out[row * size + k]) of at most kBlockSize readings
template <class Evaluate>
std::vector<double> rows_by_reading(const Observations& observations, int threads, const Evaluate& evaluate) {
  const std::size_t rows = static_cast<std::size_t>(observations.rows()), count = observations.reading_count();
  std::vector<double> result(rows * count);
  constexpr std::size_t kBlock = Observations::kBlockSize;
  for_each_block((count + kBlock - 1) / kBlock, threads, [&](std::size_t block) {
    const std::size_t first = block * kBlock, size = std::min(kBlock, count - first);
    std::vector<double> values(rows * size);
    evaluate(first, size, values.data());
    for (std::size_t k = 0; k < size; ++k)
      for (std::size_t r = 0; r < rows; ++r) result[(first + k) * rows + r] = values[r * size + k];
  });
  return result;
}

}  // namespace

std::vector<double> residuals_by_reading(const Observations& observations, int threads) {
  return rows_by_reading(observations, threads, [&](std::size_t first, std::size_t size, double* out) {
    observations.evaluate(first, size, {}, {}, out, nullptr, 0);
  });
}

std::vector<double> deviations_by_reading(const Observations& observations, int threads) {
  return rows_by_reading(observations, threads, [&](std::size_t first, std::size_t size, double* out) {
    observations.deviations(first, size, out);
  });
}

std::vector<double> lengths_by_reading(const Observations& observations, int threads) {
  const std::vector<ReadingComponent>& components = observations.components();
  const std::vector<double> deviations = deviations_by_reading(observations, threads);
  std::vector<double> lengths(observations.reading_count());
  for (std::size_t k = 0; k < lengths.size(); ++k) {
    double square = -1;
    for (std::size_t row = 0; row < components.size(); ++row) {
      const double deviation = deviations[k * components.size() + row];
      if (!components[row].is_angle) square = std::max(square, 0.0) + deviation * deviation;
    }
    lengths[k] = square < 0 ? -1 : std::sqrt(square);
  }
  return lengths;
}

}  // namespace abbe
