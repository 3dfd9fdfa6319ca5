#include "abbe/verify/volumetric_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "abbe/machine/axis_unit.h"
#include "abbe/verify/known_range.h"

namespace abbe {
namespace {

constexpr double kTwoUncertainties = 2;  // k

/// Lengths of the uncertainty of the displacement, k = 2.
std::vector<double> left_at_poses(const ErrorMap& map) {
  std::vector<double> left(map.count(), 0);
  for (std::size_t k = 0; k < left.size(); ++k) {
    left[k] = kTwoUncertainties * std::hypot(map.uncertainty[0][k], map.uncertainty[1][k], map.uncertainty[2][k]);
  }
  return left;
}

}  // namespace

void keep_common_poses(std::span<ErrorMap* const> maps) {
  std::vector<std::uint8_t> covered = maps.front()->covered;
  for (const ErrorMap* map : maps) {
    for (std::size_t k = 0; k < covered.size(); ++k) {
      if (map->covered[k] == 0) covered[k] = 0;
    }
  }
  for (ErrorMap* map : maps) {
    map->covered = covered;
    map->statistics = sample_statistics(map->norm, covered);
  }
}

std::string ranges_text(const Machine& machine, const std::vector<AxisRange>& ranges) {
  std::string text;
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const double unit = position_unit(machine.axes[i]);
    const char* const name = position_suffix(machine.axes[i]);
    text += fmt::format("{}{} ", i > 0 ? ", " : "", machine.axes[i].name);
    if (ranges[i].is_fixed()) {
      text += fmt::format("{:.6g} {}", ranges[i].from / unit, name);
    } else {
      text += fmt::format("{:.6g} to {:.6g} {}", ranges[i].from / unit, ranges[i].to / unit, name);
    }
  }
  return text;
}

std::vector<AxisRange> stated_ranges(const Machine& machine, const std::vector<const ErrorSet*>& errors) {
  return common_known_ranges(machine, errors, machine.axes.size() > 3 ? 5 : 9);
}

StatedPoses grid_over(const Machine& machine, const std::vector<AxisRange>& ranges) {
  StatedPoses stated;
  PoseGrid positions;
  for (const AxisRange& range : ranges) {
    stated.grid.push_back(range.is_fixed() ? 1 : range.count);
    positions.values.push_back(evenly_spaced(range.from, range.to, stated.grid.back()));
  }
  const PoseSource source = pose_source(positions);
  stated.poses.axis.assign(machine.axes.size(), std::vector<double>(source.count));
  std::vector<double*> pointers;
  for (std::vector<double>& values : stated.poses.axis) pointers.push_back(values.data());
  source.fill(0, source.count, pointers.data());
  for (std::size_t i = 0; i < stated.grid.size(); ++i) {
    stated.words += fmt::format("{}{}", i == 0 ? "" : " x ", stated.grid[i]);
  }
  stated.words += " poses over " + ranges_text(machine, ranges);
  return stated;
}

StatedPoses stated_grid(const Machine& machine, const std::vector<const ErrorSet*>& errors) {
  return grid_over(machine, stated_ranges(machine, errors));
}

VolumetricFigures figures_of_maps(const std::string& poses_words, ErrorMap* predicted, ErrorMap* before,
                                  ErrorMap* after) {
  std::vector<ErrorMap*> maps;
  for (ErrorMap* map : {predicted, before, after}) {
    if (map != nullptr) maps.push_back(map);
  }
  VolumetricFigures figures;
  figures.poses_words = poses_words;
  if (maps.empty()) return figures;
  keep_common_poses(maps);
  figures.poses = maps.front()->statistics.count;
  figures.outside = maps.front()->statistics.excluded;
  if (figures.poses == 0) return figures;
  if (predicted != nullptr) {
    figures.predicted_before = predicted->statistics;
    if (!predicted->uncertainty[0].empty()) {
      figures.predicted_after = sample_statistics(left_at_poses(*predicted), predicted->covered);
    }
  }
  if (before != nullptr) figures.true_before = before->statistics;
  if (after != nullptr) figures.true_after = after->statistics;
  return figures;
}

VolumetricFigures volumetric_figures(const Machine& machine, const ErrorSet* identified,
                                     const Eigen::MatrixXd& covariance, const ErrorSet* truth, const StatedPoses& poses,
                                     int threads) {
  ErrorMapOptions options;
  options.orientation = false;
  options.remove_rigid_motion = true;
  options.threads = threads;
  const PoseSource source = pose_source(poses.poses);
  std::optional<ErrorMap> predicted, before, after;
  if (identified != nullptr) {
    ErrorMapOptions with_uncertainty = options;
    ParameterCovariance parameters;
    if (covariance.size() > 0) {
      parameters.covariance = covariance;
      for (std::size_t p = 0; p < identified->parameter_count(); ++p) parameters.parameters.push_back(p);
      with_uncertainty.covariance = &parameters;
    }
    predicted = error_map(machine, *identified, nullptr, source, with_uncertainty);
  }
  if (truth != nullptr) {
    before = error_map(machine, *truth, nullptr, source, options);
    if (identified != nullptr) after = error_map(machine, *truth, identified, source, options);
  }
  const auto address = [](std::optional<ErrorMap>& map) { return map ? &*map : nullptr; };
  return figures_of_maps(poses.words, address(predicted), address(before), address(after));
}

}  // namespace abbe
