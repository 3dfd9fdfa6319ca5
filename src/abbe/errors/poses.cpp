#include "abbe/errors/poses.h"

#include <utility>

namespace abbe {

PoseSource pose_source(const PoseList& list) {
  return {list.axis.size(), list.count(), [&list](std::size_t first, std::size_t number, double* const* axis) {
            for (std::size_t i = 0; i < list.axis.size(); ++i) std::copy_n(&list.axis[i][first], number, axis[i]);
          }};
}

PoseSource pose_source(PoseGrid grid) {
  const std::size_t axes = grid.values.size();
  const std::size_t count = grid.count();
  return {axes, count, [values = std::move(grid.values)](std::size_t first, std::size_t number, double* const* axis) {
            // Every axis repeats each of its positions `repeat` times, then starts again.
            std::size_t repeat = 1;
            for (std::size_t i = values.size(); i-- > 0;) {
              std::size_t index = first / repeat % values[i].size();
              std::size_t left = repeat - first % repeat;
              for (std::size_t k = 0; k < number;) {
                const std::size_t run = std::min(left, number - k);
                std::fill_n(axis[i] + k, run, values[i][index]);
                k += run;
                index = index + 1 == values[i].size() ? 0 : index + 1;
                left = repeat;
              }
              repeat *= values[i].size();
            }
          }};
}

std::vector<double> evenly_spaced(double from, double to, std::size_t count) {
  std::vector<double> values(count);
  if (count == 1) values[0] = 0.5 * (from + to);
  for (std::size_t i = 0; count > 1 && i < count; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(count - 1);
    // Ends exactly at `to`, or a position at the limit of the travel would fall outside by rounding.
    values[i] = i + 1 == count ? to : from + share * (to - from);
  }
  return values;
}

}  // namespace abbe
