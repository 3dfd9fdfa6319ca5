#include "abbe/report/evaluations/partial_errors.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <tuple>

#include "abbe/instruments/measurement_plan.h"
#include "abbe/report/words/state_words.h"
#include "abbe/verify/known_range.h"
#include "abbe/verify/unmodelled_errors.h"

namespace abbe {
namespace {

constexpr std::size_t kPosesForParts = 250;
constexpr std::size_t kNamesShown = 6;

}  // namespace

std::string PartialErrors::short_words() const { return fmt::format("{} of the {} errors", known, all()); }

std::string PartialErrors::missing_names() const {
  std::string names;
  for (std::size_t i = 0; i < std::min(missing.size(), kNamesShown); ++i) names += (i > 0 ? ", " : "") + missing[i];
  if (missing.size() > kNamesShown) names += fmt::format(" and {} more", missing.size() - kNamesShown);
  return names;
}

std::string PartialErrors::caution() const {
  return fmt::format(
      "{} of the {} errors that move the tool against the workpiece are known. The others count as zero, so the "
      "figures "
      "and their uncertainty are not those of the whole volumetric error. Not known: {}.",
      known, all(), missing_names());
}

std::size_t known_error_count(const Machine& machine, const ErrorSet& errors) {
  std::set<std::tuple<std::size_t, Component, bool>> known;
  for (const ErrorMotion& motion : errors.motions) known.emplace(motion.axis, motion.component, false);
  for (const LocationError& location : errors.locations) {
    if (is_zero_position_error(machine.axes[location.axis], location.component)) continue;
    known.emplace(location.axis, location.component, true);
  }
  return known.size();
}

PartialErrors partial_errors(const Machine& machine, const ErrorsFile& file) {
  PartialErrors partial;
  partial.known = known_error_count(machine, file.errors);
  partial.at_state = file.at_state;
  if (is_truth(file)) return partial;
  std::vector<AxisRange> ranges;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) ranges.push_back(known_range(machine, file.errors, i, 2));
  const PoseList poses = random_plan(machine, ranges, kPosesForParts, 1);
  for (const UnmodelledError& error : unmodelled_errors(machine, file.errors, pose_source(poses))) {
    partial.missing.push_back(error.is_location ? location_error_name(machine, error.axis, error.component)
                                                : error_motion_name(machine, error.axis, error.component));
  }
  return partial;
}

void add_partial_errors(const PartialErrors& errors, nlohmann::ordered_json& json) {
  add_state(errors.at_state, json);
  if (!errors.is_partial()) return;
  json["errors_known"] = errors.known;
  json["errors_of_machine"] = errors.all();
  json["not_known"] = errors.missing;
  json["caution"] = errors.caution();
}

}  // namespace abbe
