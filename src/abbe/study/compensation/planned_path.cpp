#include "abbe/study/compensation/planned_path.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "abbe/errors/calibrated_machine.h"
#include "abbe/formats/machine/machine_couplings.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/machine/axis_unit.h"
#include "abbe/study/compensation/path_errors.h"

namespace abbe {
namespace {

CalibratedMachine calibrated_for_path(const PathRequest& request, PlannedPath& planned) {
  if (!request.errors) return {request.machine, std::vector<double>(request.machine.axes.size(), 0.0), {}};
  refuse_couplings(request.machine, "a path with errors");
  refuse_states(request.machine, request.errors->errors, "a path", UsableStates::of_motions);
  ErrorsOfPath errors = errors_of_path(request.machine, request.errors->errors);
  planned.errors_along = std::move(errors.along);
  return calibrated_machine(request.machine, errors.constant);
}

/// The curve with a feed wherever the tool works, and positions for commands.
Curve curve_on(const CalibratedMachine& calibrated, const PathRequest& request) {
  Curve curve = request.curve;
  for (CurvePoint& point : curve.points) {
    if (!(point.feed > 0)) point.feed = request.feed;
    if (point.working && !(point.feed > 0)) {
      throw InputError({.file = request.curve_file}, "moves at work without a feed",
                       "a column feed_mm_per_min, F in a program, or --feed-mm-per-min");
    }
    for (std::size_t k = 0; k < curve.indexed.size(); ++k) point.indexed[k] += calibrated.zero[curve.indexed[k]];
  }
  return curve;
}

ToolPathOptions tool_path_options(const CalibratedMachine& calibrated, const PathRequest& request) {
  ToolPathOptions options;
  options.retract = request.retract;
  options.tolerance = request.tolerance;
  const std::vector<std::size_t>& indexed = request.curve.indexed;
  for (HeldAxis held : request.held) {
    if (std::find(indexed.begin(), indexed.end(), held.axis) != indexed.end()) {
      const Axis& axis = request.machine.axes.at(held.axis);
      throw InputError({.field = fmt::format("--hold {}_{}={:g}", axis.name, position_suffix(axis),
                                             held.position / position_unit(axis))},
                       "the curve gives this axis its commands", "an axis of its own");
    }
    held.position += calibrated.zero.at(held.axis);
    options.path.inverse.held.push_back(held);
  }
  if (!request.start.empty()) {
    options.path.start.assign(request.machine.axes.size(), std::numeric_limits<double>::quiet_NaN());
    for (const HeldAxis& at : request.start) {
      options.path.start.at(at.axis) = at.position + calibrated.zero.at(at.axis);
    }
  }
  return options;
}

void refuse_bad_request(const ToolPath& path, const PathRequest& request) {
  switch (path.status) {
    case ToolPathStatus::no_retract:
      throw InputError({.field = "--retract-mm"}, path.message, "a distance above zero");
    case ToolPathStatus::invalid_options:
      throw InputError({.file = request.curve_file}, path.message);
    case ToolPathStatus::start_undecided:
      throw InputError({.field = "--start"}, path.message);
    default:
      break;
  }
}

}  // namespace

PlannedPath plan_path(const PathRequest& request) {
  PlannedPath result;
  const CalibratedMachine calibrated = calibrated_for_path(request, result);
  result.machine = calibrated.machine;
  result.curve_file = request.curve_file;
  if (request.errors) result.at_state = request.errors->at_state;
  result.placement_file = request.placement_file;
  if (request.placement) {
    result.machine = with_workpiece(result.machine, request.placement->placement);
    result.warnings = request.placement->warnings;
  }
  const Curve curve = curve_on(calibrated, request);
  const ToolPathOptions options = tool_path_options(calibrated, request);
  result.path = plan_tool_path(result.machine, curve, options);
  refuse_bad_request(result.path, request);
  if (!result.has_path()) {
    result.refused =
        fmt::format("point {} of {}: {}", result.path.failed_point + 1, request.curve_file, result.path.message);
    return result;
  }
  for (const ToolPathStep& step : result.path.steps) {
    std::vector<double> row(result.machine.axes.size());
    for (std::size_t i = 0; i < row.size(); ++i) row[i] = step.command[i] - calibrated.zero[i];
    result.commands.push_back(std::move(row));
  }
  result.miss = largest_miss(result.machine, curve, result.path);
  if (!result.errors_along.empty()) {
    Machine nominal = request.machine;
    if (request.placement) nominal = with_workpiece(nominal, request.placement->placement);
    correct_along_path(request, nominal, calibrated.zero, curve, result);
    if (!result.refused.empty()) return result;
  }
  if (result.path.status == ToolPathStatus::jumps_while_working) {
    result.refused = result.path.message + ": another start (--start), a held axis, or a cut of the curve there";
  }
  return result;
}

}  // namespace abbe
