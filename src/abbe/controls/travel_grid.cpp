#include "abbe/controls/travel_grid.h"

#include <fmt/format.h>

#include <utility>

#include "abbe/compensate/point_correction.h"
#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

constexpr double kAside = 0.19;
constexpr double kMostPoses = 1e6;

}  // namespace

std::size_t judged_positions(const Machine& machine, const std::optional<std::size_t>& positions) {
  const std::size_t axes = machine.axes.size();
  if (!positions) return axes > 3 ? 5 : 9;
  double poses = 1;
  for (std::size_t i = 0; i < axes; ++i) poses *= static_cast<double>(*positions);
  if (*positions < 2 || poses > kMostPoses) {
    throw InputError({.field = fmt::format("--positions {}", *positions)},
                     fmt::format("{:.0f} poses for {} axes", poses, axes),
                     "at least 2 positions per axis and at most 1,000,000 poses");
  }
  return *positions;
}

PoseList travel_grid(const Machine& machine, const ErrorSet& errors, std::size_t count,
                     std::vector<std::size_t>& grid) {
  PoseGrid positions;
  grid.clear();
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const KnownTravel travel = known_travel(machine, errors, i);
    std::vector<double> values;
    if (!(travel.to > travel.from)) {
      values = {travel.from};
    } else if (travel.whole_turn) {
      values = evenly_spaced(travel.from, travel.to, count + 1);
      values.pop_back();
    } else {
      values = evenly_spaced(travel.from, travel.to, count);
    }
    // Off round fractions of the travel, where nodes of tables are and the interpolation has no error.
    const double aside = kAside * (travel.to - travel.from) / static_cast<double>(count);
    for (std::size_t k = 1; k + 1 < values.size(); ++k) values[k] += k % 2 == 0 ? aside : -aside;
    grid.push_back(values.size());
    positions.values.push_back(std::move(values));
  }
  const PoseSource source = pose_source(positions);
  PoseList poses;
  poses.axis.assign(machine.axes.size(), std::vector<double>(source.count));
  std::vector<double*> pointers;
  for (std::vector<double>& values : poses.axis) pointers.push_back(values.data());
  source.fill(0, source.count, pointers.data());
  return poses;
}

}  // namespace abbe
