#include <fmt/compile.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <string>
#include <vector>

#include "abbe/formats/text/csv_reader.h"
#include "abbe/geometry/parallel_blocks.h"
#include "abbe/machine/axis_unit.h"
#include "abbe/study/report/report_residuals.h"
#include "abbe/study/report/results.h"

namespace abbe {
namespace {

constexpr std::size_t kTogether = 4096;  // readings

/// Rows of one set-up, a line for each component of a reading.
class ResidualRows {
 public:
  ResidualRows(const Machine& machine, const StudyResult& result, std::size_t s)
      : observations_(*result.model.problem.observations[s].observations),
        use_(result.model.problem.observations[s].use),
        points_(result.campaign.setups[s].readings.point_name),
        name_(csv_field(result.campaign.setups[s].name)),
        components_(residual_components(observations_)),
        weights_(observations_.reading_count(), 1.0) {
    for (const Axis& axis : machine.axes) per_unit_.push_back(1 / position_unit(axis));
    for (const Outlier& outlier : result.identification.outliers)
      if (outlier.observations == s) weights_[outlier.reading] = outlier.weight;
  }

  std::size_t block_count() const { return (weights_.size() + kTogether - 1) / kTogether; }

  std::string block(std::size_t number) const {
    const std::size_t first = number * kTogether, last = std::min(first + kTogether, weights_.size());
    std::string text, start;
    for (std::size_t k = first; k < last; ++k) {
      start.clear();
      auto out = std::back_inserter(start);
      fmt::format_to(out, FMT_COMPILE("{},{},"), name_, k);
      if (!points_.empty() && !points_[k].empty()) start += csv_field(points_[k]);
      const std::vector<double> positions = observations_.positions(k);
      for (std::size_t i = 0; i < positions.size(); ++i)
        fmt::format_to(out, FMT_COMPILE(",{:.9g}"), positions[i] * per_unit_[i]);
      fmt::format_to(out, FMT_COMPILE(",{},{:.4g}"), use_.empty() || use_[k] != 0 ? 1 : 0, weights_[k]);
      for (const ResidualComponent& component : components_) {
        fmt::format_to(std::back_inserter(text), FMT_COMPILE("{},{},{:.5g},{:.5g},{}\n"), start, component.name,
                       component.normalised[k], component.residual[k], component.unit);
      }
    }
    return text;
  }

 private:
  const Observations& observations_;
  const std::vector<std::uint8_t>& use_;
  const std::vector<std::string>& points_;
  std::string name_;
  std::vector<ResidualComponent> components_;
  std::vector<double> weights_;   // [readings]
  std::vector<double> per_unit_;  // [axes]
};

}  // namespace

std::string residuals_csv(const Study& study, const StudyResult& result) {
  std::string text = "setup,reading,point";
  for (const Axis& axis : study.machine.axes) text += fmt::format(",{}_{}", axis.name, position_suffix(axis));
  text += ",used,weight,component,normalised,residual,unit\n";
  for (std::size_t s = 0; s < result.model.problem.observations.size(); ++s) {
    const ResidualRows rows(study.machine, result, s);
    std::vector<std::string> blocks(rows.block_count());
    for_each_block(blocks.size(), study.threads, [&](std::size_t number) { blocks[number] = rows.block(number); });
    for (const std::string& block : blocks) text += block;
  }
  return text;
}

}  // namespace abbe
