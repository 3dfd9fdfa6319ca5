#include "abbe/study/compensation/frozen_errors.h"

#include <fmt/format.h>

#include <cmath>

#include "abbe/compensate/program/program_uncertainty.h"
#include "abbe/formats/machine/correction_limits.h"
#include "abbe/formats/machine/machine_couplings.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/machine/state_option.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/machine/position_words.h"
#include "abbe/report/version.h"

namespace abbe {
namespace {

/// A frozen compensation that differs more from the full model of the same errors is not given out, mm.
constexpr double kLargestFreezeDifference = 1e-6;

/// Ranges that are stated, else those that the readings of the errors covered.
std::vector<StateRange> ranges_to_freeze(const FreezeRequest& request) {
  const auto stated = state_range_options(request.machine, "--state-range", request.state_ranges);
  std::vector<StateRange> ranges(stated.size());
  for (std::size_t j = 0; j < stated.size(); ++j) {
    if (stated[j]) {
      ranges[j] = {stated[j]->first, stated[j]->second};
      continue;
    }
    for (const CoveredState& covered : request.errors.covered) {
      if (covered.column == state_column(request.machine.states[j]) && covered.from < covered.to) {
        ranges[j] = {covered.from, covered.to};
      }
    }
  }
  return ranges;
}

FreezeOptions freeze_options(const FreezeRequest& request) {
  FreezeOptions options;
  options.tool = request.tool.value_or(request.machine.tool_offset);
  if (!options.tool.allFinite()) throw InputError({.field = "--tool-mm"}, "not finite", "three lengths in mm");
  options.tool_length_min = request.tool_length_min;
  options.tool_length_max = request.tool_length_max;
  if (!(request.tool_length_min <= request.tool_length_max) ||
      !std::isfinite(request.tool_length_max - request.tool_length_min)) {
    throw InputError({.field = "--tool-length-mm"}, "the range is empty", "the lower end first, in mm");
  }
  check_largest_turn(request.largest_turn);
  options.largest_turn = request.largest_turn;
  options.world_zero_at_joints = request.world_zero_at_joints;
  options.covariance = parameter_covariance(request.errors.errors, request.errors.covariance);
  options.source = machine_text(request.machine) + errors_text(request.machine, request.errors);
  options.version = version_text();
  options.state_ranges = ranges_to_freeze(request);
  return options;
}

/// Why no pose was compensated, and what can be done.
std::string nothing_reached(const FrozenCompensation& frozen) {
  if (frozen.unreached < frozen.poses) {
    return "the remaining error is not known: at every pose that was reached, a correction leads out of the range "
           "where the errors are known; state the errors over the whole travel";
  }
  std::string text =
      fmt::format("the remaining error is not known: at none of {} poses can the axes correct the position completely",
                  frozen.poses);
  if (frozen.point_axes < 3) {
    text += fmt::format(
        ". This takes three linear axes, or two linear axes and one rotary axis; this machine has {} such ax{}. "
        "Correct the errors of an arm in the parameters of its control instead",
        frozen.point_axes == 0 ? "no" : fmt::format("{}", frozen.point_axes), frozen.point_axes == 1 ? "is" : "es");
  } else {
    text += ". Check whether the errors are larger than the largest correction (10 mm, and --largest-turn-deg)";
  }
  return text;
}

}  // namespace

FrozenErrors freeze_errors(const FreezeRequest& request) {
  if (request.leave_out_factor > 0) {
    refuse_couplings(request.machine, "--leave-out-below-uncertainty");
    refuse_states(request.machine, request.errors.errors, "--leave-out-below-uncertainty");
  }
  check_leave_out(request.leave_out_factor, request.errors.errors, request.errors.covariance, request.errors_file);
  const double limit_um = refusal_limit("--limit-um", request.limit_um, "um");
  FreezeOptions options = freeze_options(request);
  FrozenErrors result;
  result.machine = request.machine;
  result.errors_file = request.errors_file;
  result.at_state = request.errors.at_state;
  result.tool_length_min = request.tool_length_min;
  result.tool_length_max = request.tool_length_max;
  result.leave_out_factor = request.leave_out_factor;
  result.errors = request.errors.errors;
  if (request.leave_out_factor > 0) {
    result.left_out = leave_out_uncertain(request.machine, result.errors, options.covariance, request.leave_out_factor,
                                          tools_tried(request.machine, options));
    options.all_errors = request.errors.errors;
  }
  result.frozen = freeze(request.machine, result.errors, options);
  const FrozenCompensation& frozen = result.frozen;
  if (!frozen.problem.empty()) throw InputError({.file = request.errors_file}, "cannot be frozen: " + frozen.problem);
  if (!(1e3 * frozen.largest_correction <= limit_um)) {
    result.refused = fmt::format("the correction is {:.1f} um, above --limit-um {:g}, at {}, tool {:g} mm",
                                 1e3 * frozen.largest_correction, limit_um,
                                 position_words(request.machine, frozen.where, "{:.4g}"), frozen.tool_length_there);
  } else if (frozen.points_compared == 0) {
    result.refused = nothing_reached(frozen);
  } else if (!(frozen.difference <= kLargestFreezeDifference)) {
    result.refused = fmt::format("the frozen compensation differs by {:.2e} mm from the full model", frozen.difference);
  }
  return result;
}

}  // namespace abbe
