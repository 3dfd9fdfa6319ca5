#include "study/volumetric_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "abbe/compensate/correction_uncertainty.h"
#include "axis_unit.h"
#include "study/job.h"
#include "study/summary.h"

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

double mean_in_um(const SampleStatistics& statistics) { return 1e3 * statistics.mean; }

}  // namespace

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
  std::vector<AxisRange> ranges;
  const std::size_t count = machine.axes.size() > 3 ? 5 : 9;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    AxisRange range = known_range(machine, *errors.front(), i, count);
    for (const ErrorSet* set : errors) {
      const AxisRange other = known_range(machine, *set, i, count);
      // Ranges without a position in common stay: their poses have no result, and that is said.
      if (std::max(range.from, other.from) > std::min(range.to, other.to)) continue;
      range.from = std::max(range.from, other.from);
      range.to = std::min(range.to, other.to);
    }
    range.count = range.is_fixed() ? 1 : count;
    ranges.push_back(range);
  }
  return ranges;
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

bool is_truth(const ErrorsFile& file) {
  return std::any_of(file.provenance.begin(), file.provenance.end(),
                     [](const auto& entry) { return entry.first == "method" && entry.second == kTruthOfSimulation; });
}

Eigen::MatrixXd covariance_of(const ErrorsFile& file) {
  return file.covariance.size() > 0 ? file.covariance : stated_variances(file.errors);
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

void print_error_line(const std::string& name, const SampleStatistics& s) {
  fmt::print("  {:<46} mean {:>9.3f}   95 % {:>9.3f}   max {:>9.3f} um\n", name, 1e3 * s.mean, 1e3 * s.p95,
             1e3 * s.maximum);
}

void print_volumetric_figures(const VolumetricFigures& figures, const std::string& covers) {
  if (figures.poses == 0) return;
  fmt::print("volumetric error over {}, after the best fit of the workpiece datum\n", figures.poses_words);
  if (figures.predicted_before) print_error_line("predicted volumetric error, before", *figures.predicted_before);
  if (figures.predicted_after) {
    print_error_line("predicted volumetric error, after (k = 2)", *figures.predicted_after);
    if (!covers.empty()) fmt::print("    (of the {})\n", covers);
  }
  if (figures.true_before) print_error_line("true volumetric error, before", *figures.true_before);
  if (figures.true_after) print_error_line("true volumetric error, after", *figures.true_after);
  if (figures.outside > 0) {
    fmt::print("  left out: {} poses outside the range in which the errors are known\n", figures.outside);
  }
}

void add_volumetric_figures(const VolumetricFigures& figures, nlohmann::ordered_json& json, const std::string& covers) {
  const auto object = [&] {
    nlohmann::ordered_json entry;
    entry["poses"] = figures.poses;
    entry["description"] = figures.poses_words + ", after the best fit of the workpiece datum";
    if (figures.outside > 0) entry["outside_range"] = figures.outside;
    return entry;
  };
  if (figures.predicted_before) {
    nlohmann::ordered_json entry = object();
    entry["before_um"] = statistics_um(*figures.predicted_before);
    if (figures.predicted_after) {
      entry["after_expanded_um"] = statistics_um(*figures.predicted_after);
      if (!covers.empty()) entry["uncertainty_covers"] = covers;
    }
    json["predicted_volumetric_error"] = entry;
  }
  if (figures.true_before) {
    nlohmann::ordered_json entry = object();
    entry["before_um"] = statistics_um(*figures.true_before);
    if (figures.true_after) entry["after_um"] = statistics_um(*figures.true_after);
    json["true_volumetric_error"] = entry;
  }
}

std::string volumetric_sentence(const VolumetricFigures& figures, const std::string& covers) {
  const std::string of = covers.empty() ? "" : ", " + covers;
  const std::string where = fmt::format("mean over {}", figures.poses_words);
  if (figures.true_before && figures.true_after) {
    const std::string predicted = figures.predicted_after ? fmt::format(" (predicted: {:.3g} um, k = 2{})",
                                                                        mean_in_um(*figures.predicted_after), of)
                                                          : "";
    return fmt::format("True volumetric error {:.4g} um before, {:.3g} um after correction{}, {}.",
                       mean_in_um(*figures.true_before), mean_in_um(*figures.true_after), predicted, where);
  }
  if (!figures.predicted_before) return "";
  const std::string after = figures.predicted_after ? fmt::format(", {:.3g} um (k = 2{}) after correction",
                                                                  mean_in_um(*figures.predicted_after), of)
                                                    : "";
  return fmt::format("Predicted volumetric error {:.4g} um before{}, {}.", mean_in_um(*figures.predicted_before), after,
                     where);
}

}  // namespace abbe
