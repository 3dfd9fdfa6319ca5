#include "abbe/identify/trust/repeated_readings.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "abbe/geometry/angle_units.h"
#include "abbe/identify/distributions.h"
#include "abbe/identify/identify.h"

namespace abbe {
namespace {

constexpr double kCopiesByChance = 1e-4;
constexpr int kMostDecimals = 12;
constexpr double kDigitsPerStep = 5;  // an instrument may count in fives of its last digit
constexpr std::size_t kSampledValues = 2000;

/// FNV-1a over the bits of numbers.
class NumberHash {
 public:
  void add(double value) {
    hash_ = (hash_ ^ std::bit_cast<std::uint64_t>(value + 0.0)) * 0x100000001b3U;  // -0 is 0
    hash_ ^= hash_ >> 29U;
  }
  std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325U;
};

/// Evenly chosen elements.
std::vector<double> sample_of(const std::vector<double>& values) {
  if (values.size() <= kSampledValues) return values;
  std::vector<double> chosen;
  for (std::size_t i = 0; i < kSampledValues; ++i) chosen.push_back(values[i * values.size() / kSampledValues]);
  return chosen;
}

/// Step in which numbers are written, the coarsest that explains them in any of the units.
double written_step(const std::vector<double>& values) {
  double coarsest = 0;
  for (const double unit : {1.0, 25.4, kDegree, kArcsec}) {
    double step = 1;
    for (int decimals = 0; decimals <= kMostDecimals; ++decimals, step /= 10) {
      const bool fits = std::all_of(values.begin(), values.end(), [&](double value) {
        const double steps = value / unit / step;
        return std::abs(steps - std::round(steps)) < 1e-4 + 1e-14 * std::abs(steps);
      });
      if (fits || decimals == kMostDecimals) break;
    }
    coarsest = std::max(coarsest, step * unit);
  }
  return coarsest;
}

double median_size(std::vector<double> values) {
  if (values.empty()) return 0;
  for (double& value : values) value = std::abs(value);
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Probability that two independent readings agree in every number.
double chance_of_agreement(const Observations& observations, const ReadingFacts& facts) {
  const std::size_t rows = static_cast<std::size_t>(observations.rows()), count = observations.reading_count();
  const std::vector<double> residuals = residuals_by_reading(observations);
  double chance = 1;
  for (std::size_t row = 0; row < std::min(rows, facts.measured.size()); ++row) {
    std::vector<double> deviation, residual;
    for (std::size_t i = 0; i < std::min(count, kSampledValues); ++i) {
      const std::size_t k = count <= kSampledValues ? i : i * count / kSampledValues;
      deviation.push_back(observations.deviation(k)[row]);
      residual.push_back(residuals[k * rows + row]);
    }
    const double normalised = median_size(residual);
    if (!(normalised > 0)) return 1;
    const double u = median_size(deviation) / normalised;
    const double step = kDigitsPerStep * facts.arm[row] * written_step(sample_of(facts.measured[row]));
    if (u > 0) chance *= std::min(1.0, step / (2 * std::sqrt(std::numbers::pi) * u));
  }
  return chance;
}

struct ReadingKey {
  std::uint64_t place = 0, measured = 0;  ///< where and on what it was taken; what was read
  std::size_t reading = 0;
  auto operator<=>(const ReadingKey&) const = default;
};

std::vector<ReadingKey> sorted_keys(const Observations& observations, const ReadingFacts& facts) {
  std::vector<ReadingKey> keys;
  for (std::size_t k = 0; k < observations.reading_count(); ++k) {
    NumberHash place, measured;
    for (const double position : observations.positions(k)) place.add(position);
    for (const ReadingLabel& label : facts.labels) place.add(label.of_reading[k]);
    for (const std::vector<double>& input : facts.inputs) place.add(input[k]);
    for (const std::vector<double>& component : facts.measured) measured.add(component[k]);
    keys.push_back({place.value(), measured.value(), k});
  }
  std::sort(keys.begin(), keys.end());
  return keys;
}

std::size_t pairs_of(std::size_t count) { return count * (count - 1) / 2; }

}  // namespace

bool RepeatedReadings::are_copies() const { return probability < kCopiesByChance; }

RepeatedReadings repeated_readings(const Observations& observations, const ReadingFacts& facts) {
  RepeatedReadings repeated;
  if (facts.measured.empty()) return repeated;
  const std::vector<ReadingKey> keys = sorted_keys(observations, facts);
  bool found = false;
  for (std::size_t first = 0, last = 0; first < keys.size(); first = last) {
    while (last < keys.size() && keys[last].place == keys[first].place) ++last;
    repeated.pairs += pairs_of(last - first);
    for (std::size_t same = first, end = first; same < last; same = end) {
      while (end < last && keys[end].measured == keys[same].measured) ++end;
      repeated.identical += pairs_of(end - same);
      if (end - same > 1 && (!found || keys[same].reading < repeated.first)) {
        found = true;
        repeated.first = keys[same].reading;
        repeated.second = keys[same + 1].reading;
      }
    }
  }
  if (repeated.identical == 0) return repeated;
  const double chance = chance_of_agreement(observations, facts);
  repeated.expected = chance * static_cast<double>(repeated.pairs);
  // Binomial: k or more of n.
  const double n = static_cast<double>(repeated.pairs), k = static_cast<double>(repeated.identical);
  if (chance < 1) repeated.probability = incomplete_beta(k, n - k + 1, chance);
  return repeated;
}

std::string copies_text(const RepeatedReadings& repeated, const ReadingFacts& facts) {
  return fmt::format(
      "set-up {}: {} of {} pairs of readings at the same pose agree to the last digit, first rows {} and {}; by the "
      "stated uncertainty about {:.2g} would. These are duplicate rows, or one reading used for several. They "
      "count as independent, so that the stated uncertainties of the result are too small.",
      facts.setup, repeated.identical, repeated.pairs, repeated.first + 1, repeated.second + 1, repeated.expected);
}

}  // namespace abbe
