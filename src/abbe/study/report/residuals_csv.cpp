#include <fmt/compile.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "abbe/formats/text/csv_reader.h"
#include "abbe/geometry/digest.h"
#include "abbe/machine/axis_unit.h"
#include "abbe/study/report/results.h"
#include "abbe/study/results_of_items.h"

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
        weights_(observations_.reading_count(), 1.0) {
    for (const Axis& axis : machine.axes) per_unit_.push_back(1 / position_unit(axis));
    for (const ReadingComponent& component : observations_.components()) {
      columns_.push_back({component.name, micro_unit(component.is_angle), micro_per_unit(component.is_angle)});
    }
    for (const Outlier& outlier : result.identification.outliers)
      if (outlier.observations == s) weights_[outlier.reading] = outlier.weight;
  }

  std::size_t block_count() const { return (weights_.size() + kTogether - 1) / kTogether; }

  /// What the rows depend on besides the residuals.
  void add_to(Digest& digest) const {
    digest.add_text(name_);
    digest.add(points_.size());
    for (const std::string& point : points_) digest.add_text(point);
    for (const Column& column : columns_) digest.add_text(column.name + column.unit);
    digest.add_bytes(std::as_bytes(std::span(use_)));
    digest.add_numbers(weights_);
    digest.add_numbers(per_unit_);
  }

  std::string block(std::size_t number) const {
    const std::size_t end = std::min((number + 1) * kTogether, weights_.size()), rows = columns_.size();
    std::vector<double> normalised(rows * Observations::kBlockSize), residual(normalised.size());
    fmt::memory_buffer text, start;
    for (std::size_t first = number * kTogether; first < end; first += Observations::kBlockSize) {
      const std::size_t count = std::min(Observations::kBlockSize, end - first);
      observations_.evaluate(first, count, {}, {}, normalised.data(), nullptr, 0);
      observations_.deviations(first, count, residual.data());
      for (std::size_t k = 0; k < count; ++k) {
        start.clear();
        write_start(first + k, start);
        for (std::size_t row = 0; row < rows; ++row) {
          text.append(start);
          const Column& column = columns_[row];
          fmt::format_to(std::back_inserter(text), FMT_COMPILE("{},{:.5g},{:.5g},{}\n"), column.name,
                         normalised[row * count + k], residual[row * count + k] * column.micro_per_unit, column.unit);
        }
      }
    }
    return fmt::to_string(text);
  }

 private:
  struct Column {
    std::string name, unit;
    double micro_per_unit = 1;
  };

  void write_start(std::size_t reading, fmt::memory_buffer& text) const {
    auto out = std::back_inserter(text);
    fmt::format_to(out, FMT_COMPILE("{},{},"), name_, reading);
    if (!points_.empty() && !points_[reading].empty()) text.append(csv_field(points_[reading]));
    const std::vector<double> positions = observations_.positions(reading);
    for (std::size_t i = 0; i < positions.size(); ++i)
      fmt::format_to(out, FMT_COMPILE(",{:.9g}"), positions[i] * per_unit_[i]);
    const int used = use_.empty() || use_[reading] != 0 ? 1 : 0;
    fmt::format_to(out, FMT_COMPILE(",{},{:.4g},"), used, weights_[reading]);
  }

  const Observations& observations_;
  const std::vector<std::uint8_t>& use_;
  const std::vector<std::string>& points_;
  std::string name_;
  std::vector<Column> columns_;   // [components]
  std::vector<double> weights_;   // [readings]
  std::vector<double> per_unit_;  // [axes]
};

}  // namespace

std::string residuals_csv(const Study& study, const StudyResult& result, const WorkDriver& work) {
  std::vector<ResidualRows> setups;
  std::vector<std::pair<std::size_t, std::size_t>> blocks;  // set-up, block of it
  for (std::size_t s = 0; s < result.model.problem.observations.size(); ++s) {
    setups.emplace_back(study.machine, result, s);
    for (std::size_t number = 0; number < setups[s].block_count(); ++number) blocks.emplace_back(s, number);
  }
  NumberedItems items{.name = "residuals", .count = blocks.size(), .threads = study.threads};
  items.for_all = false;
  items.fingerprint = [&] {
    Digest digest;  // the sums that led to the estimates have required equal readings
    for (const ResidualRows& rows : setups) rows.add_to(digest);
    digest.add_numbers(
        {result.identification.estimates.data(), static_cast<std::size_t>(result.identification.estimates.size())});
    return digest.value();
  };
  items.compute = [&](std::size_t item) {
    return ItemResult{{}, setups[blocks[item].first].block(blocks[item].second)};
  };
  std::string text = "setup,reading,point";
  for (const Axis& axis : study.machine.axes) text += fmt::format(",{}_{}", axis.name, position_suffix(axis));
  text += ",used,weight,component,normalised,residual,unit\n";
  for (const ItemResult& block : results_of_items(work, items)) text += block.text;
  return text;
}

}  // namespace abbe
