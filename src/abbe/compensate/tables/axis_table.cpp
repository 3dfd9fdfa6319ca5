#include "abbe/compensate/tables/axis_table.h"

#include <algorithm>
#include <cmath>

namespace abbe {

double AxisTable::at(double position, int approach) const {
  const auto value = [&](std::size_t i) {
    return approach > 0 ? forward[i] : approach < 0 ? reverse[i] : 0.5 * (forward[i] + reverse[i]);
  };
  const double first = positions.front(), last = positions.back();
  if (modulo && last > first) position -= (last - first) * std::floor((position - first) / (last - first));
  if (!(position > first)) return value(0);
  if (position >= last) return value(positions.size() - 1);
  const auto after =
      static_cast<std::size_t>(std::upper_bound(positions.begin(), positions.end(), position) - positions.begin());
  const double share = (position - positions[after - 1]) / (positions[after] - positions[after - 1]);
  return value(after - 1) + share * (value(after) - value(after - 1));
}

void AxisTableCorrection::evaluate(const PoseList& commands, PoseList& correction) const {
  correction.axis.assign(commands.axis.size(), std::vector<double>(commands.count(), 0.0));
  for (const AxisTable& table : tables_) {
    const std::vector<double>& input = commands.axis[table.input];
    std::vector<double>& output = correction.axis[table.output];
    for (std::size_t k = 0; k < input.size(); ++k) {
      output[k] += table.at(input[k], commands.approach.empty() ? 0 : commands.approach[table.input][k]);
    }
  }
}

bool AxisTableCorrection::knows_directions() const {
  return std::any_of(tables_.begin(), tables_.end(),
                     [](const AxisTable& table) { return table.forward != table.reverse; });
}

double largest_correction(const AxisTable& table) {
  double largest = 0;
  for (const double value : table.forward) largest = std::max(largest, std::abs(value));
  for (const double value : table.reverse) largest = std::max(largest, std::abs(value));
  return largest;
}

}  // namespace abbe
