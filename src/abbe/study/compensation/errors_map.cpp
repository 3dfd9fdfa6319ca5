#include "abbe/study/compensation/errors_map.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "abbe/formats/machine/workpiece_option.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/report/evaluations/statistics_json.h"
#include "abbe/report/words/state_words.h"
#include "abbe/report/words/volumetric_words.h"
#include "abbe/report/words/workpiece_words.h"
#include "abbe/study/report/results.h"

namespace abbe {
namespace {

constexpr double kMostPosesOfAMap = 20e6;

StatedPoses poses_of(const ErrorsMapRequest& request) {
  if (request.poses) return *request.poses;
  std::vector<const ErrorSet*> known = {&request.errors.errors};
  if (request.minus) known.push_back(&request.minus->errors);
  std::vector<AxisRange> ranges = stated_ranges(request.machine, known);
  for (std::size_t axis = 0; axis < request.grid.size(); ++axis) {
    if (request.grid[axis]) ranges.at(axis) = *request.grid[axis];
  }
  double count = 1;
  for (const AxisRange& range : ranges) count *= static_cast<double>(range.is_fixed() ? 1 : range.count);
  if (count > kMostPosesOfAMap) {
    throw InputError({.field = "--grid"}, fmt::format("{:.0f} poses", count), "at most 20,000,000 poses in a file");
  }
  return grid_over(request.machine, ranges);
}

/// Maps of one request, over the same poses in the same way.
class Mapping {
 public:
  Mapping(const ErrorsMapRequest& request, const JobOptions& options, const PoseList& poses)
      : machine_(request.machine), poses_(poses) {
    options_.remove_rigid_motion = request.fit_datum;
    options_.progress = stoppable_progress(options);
    options_.work = options.work;
  }

  ErrorMap with_uncertainty(const ErrorsFile& file) const {
    ParameterCovariance covariance;
    covariance.covariance = covariance_of(file);
    for (std::size_t p = 0; p < file.errors.parameter_count(); ++p) covariance.parameters.push_back(p);
    ErrorMapOptions with = options_;
    if (covariance.covariance.size() > 0) with.covariance = &covariance;
    return error_map(machine_, file.errors, nullptr, pose_source(poses_), with);
  }
  ErrorMap corrected(const ErrorsFile& file, const ErrorsFile& minus) const {
    return error_map(machine_, file.errors, &minus.errors, pose_source(poses_), options_);
  }

 private:
  const Machine& machine_;
  const PoseList& poses_;
  ErrorMapOptions options_;
};

std::string orientation_line(const char* name, const SampleStatistics& s) {
  return fmt::format("  {:<46} mean {:>9.3f}   95 % {:>9.3f}   max {:>9.3f} urad\n", name, 1e6 * s.mean, 1e6 * s.p95,
                     1e6 * s.maximum);
}

}  // namespace

ErrorsMap map_errors(const ErrorsMapRequest& request, const JobOptions& options) {
  if (request.workpiece) {
    ErrorsMapRequest with_it = request;
    with_it.workpiece.reset();
    ErrorsOnWorkpiece all =
        errors_on_workpiece(request.machine, *request.workpiece, request.errors.errors, request.errors.covariance);
    with_it.errors.errors = std::move(all.errors);
    with_it.errors.covariance = std::move(all.covariance);
    ErrorsMap map = map_errors(with_it, options);
    map.partial = partial_errors(request.machine, request.errors);
    map.workpiece = request.workpiece;
    return map;
  }
  refuse_states(request.machine, request.errors.errors, "a map of errors", UsableStates::of_commands);
  if (request.minus)
    refuse_states(request.machine, request.minus->errors, "a map of errors", UsableStates::of_commands);
  ErrorsMap map;
  map.machine = request.machine;
  map.stated = poses_of(request);
  const Mapping mapping(request, options, map.stated.poses);
  map.before = mapping.with_uncertainty(request.errors);
  if (request.minus) map.after = mapping.corrected(request.errors, *request.minus);
  std::vector<ErrorMap*> maps = {&map.before};
  if (map.after) maps.push_back(&*map.after);
  keep_common_poses(maps);
  if (request.fit_datum && is_truth(request.errors)) {
    map.after_is_true = true;
    std::optional<ErrorMap> predicted;
    if (request.minus) predicted = mapping.with_uncertainty(*request.minus);
    map.figures = figures_of_maps(map.stated.words, predicted ? &*predicted : nullptr, &map.before,
                                  map.after ? &*map.after : nullptr);
  } else if (request.fit_datum) {
    map.figures = figures_of_maps(map.stated.words, &map.before, nullptr, nullptr);
  }
  map.partial = partial_errors(request.machine, request.errors);
  return map;
}

MapData errors_map_data(const ErrorsMap& map) {
  return map_data(map.machine, map.stated.poses, map.stated.grid, map.before, map.after ? &*map.after : nullptr,
                  &map.before);
}

nlohmann::ordered_json errors_map_json(const ErrorsMap& map) {
  const ErrorMap& before = map.before;
  nlohmann::ordered_json json;
  json["machine"] = map.machine.name;
  json["poses"] = before.statistics.count;
  json["outside_range"] = before.statistics.excluded;
  if (before.statistics.count > 0) {
    if (map.figures) {
      add_volumetric_figures(*map.figures, json);
      if (map.after && !map.after_is_true) json["volumetric_error_minus_um"] = statistics_um(map.after->statistics);
    } else {
      json["displacement_before_um"] = statistics_um(before.statistics);
      if (map.after) json["displacement_after_um"] = statistics_um(map.after->statistics);
    }
    json["orientation_before_urad"] = orientation_urad(before);
    if (map.after) json["orientation_after_urad"] = orientation_urad(*map.after);
    if (!before.norm_uncertainty.empty()) {
      json["standard_uncertainty_um"] = statistics_um(sample_statistics(before.norm_uncertainty, before.covered));
    }
  }
  add_partial_errors(map.partial, json);
  add_workpiece(map.workpiece, json);
  return json;
}

std::string errors_map_text(const ErrorsMap& map) {
  const ErrorMap& before = map.before;
  const bool two = map.after.has_value();
  std::string text =
      fmt::format("{} poses of {}{}\n", before.statistics.count, map.machine.name,
                  map.partial.is_partial() ? "; known are " + map.partial.short_words() + " that it can have" : "");
  text += state_line(map.partial.at_state) + workpiece_line(map.workpiece);
  if (before.statistics.count == 0) return text;
  if (map.figures) {
    text += volumetric_text(*map.figures);
    if (two && !map.after_is_true) {
      text += error_line("difference from the errors of --minus", map.after->statistics);
    }
  } else {
    text += "displacement of the functional point, the workpiece datum as it is\n";
    text += error_line(two ? "before" : "as it is", before.statistics);
    if (two) text += error_line("after", map.after->statistics);
  }
  if (!before.norm_uncertainty.empty()) {
    text += error_line("standard uncertainty along the displacement",
                       sample_statistics(before.norm_uncertainty, before.covered));
  }
  text += orientation_line(two ? "orientation error, before" : "orientation error", orientation_statistics(before));
  if (two) text += orientation_line("orientation error, after", orientation_statistics(*map.after));
  if (map.partial.is_partial()) text += "caution: " + map.partial.caution() + "\n";
  return text;
}

}  // namespace abbe
