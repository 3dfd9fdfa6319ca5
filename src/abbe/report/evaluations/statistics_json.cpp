#include "abbe/report/evaluations/statistics_json.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

namespace abbe {
namespace {

nlohmann::ordered_json scaled(const SampleStatistics& s, double unit) {
  return {{"mean", s.mean * unit}, {"rms", s.rms * unit}, {"median", s.median * unit}, {"p90", s.p90 * unit},
          {"p95", s.p95 * unit},   {"p99", s.p99 * unit}, {"max", s.maximum * unit}};
}

}  // namespace

SampleStatistics orientation_statistics(const ErrorMap& map) {
  std::vector<double> lengths(map.rotation[0].size());
  for (std::size_t k = 0; k < lengths.size(); ++k) {
    lengths[k] = std::hypot(map.rotation[0][k], map.rotation[1][k], map.rotation[2][k]);
  }
  return sample_statistics(lengths, map.covered);
}

nlohmann::ordered_json statistics_um(const SampleStatistics& s) { return scaled(s, 1e3); }

nlohmann::ordered_json statistics_urad(const SampleStatistics& s) { return scaled(s, 1e6); }

nlohmann::ordered_json orientation_urad(const ErrorMap& map) { return statistics_urad(orientation_statistics(map)); }

}  // namespace abbe
