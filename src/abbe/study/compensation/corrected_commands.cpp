#include "abbe/study/compensation/corrected_commands.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "abbe/errors/error_states.h"
#include "abbe/formats/machine/correction_limits.h"
#include "abbe/formats/machine/machine_couplings.h"
#include "abbe/formats/machine/state_option.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/report/words/corrected_poses_words.h"
#include "abbe/report/words/state_words.h"
#include "abbe/report/words/workpiece_words.h"

namespace abbe {
namespace {

void require_workpiece_temperature(const CommandsRequest& request) {
  for (std::size_t k = 0; k < request.poses.count(); ++k) {
    if (std::isfinite(workpiece_factor(request.machine, *request.workpiece, request.poses, k))) continue;
    throw InputError({.field = state_column(request.machine.states.at(request.workpiece->state))},
                     "the temperature of the workpiece is not given at all poses", "a column with this name");
  }
}

/// Coldest and warmest.
std::pair<double, double> workpiece_temperatures(const CorrectedCommands& result) {
  if (result.workpiece->temperature) return {*result.workpiece->temperature, *result.workpiece->temperature};
  const std::vector<double>& values = result.poses.state[result.workpiece->state];
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return {*low, *high};
}

std::string workpiece_line_of(const CorrectedCommands& result) {
  if (!result.workpiece || result.poses.count() == 0) return {};
  const auto [low, high] = workpiece_temperatures(result);
  return workpiece_line(*result.workpiece, low, high);
}

void add_workpiece_of(const CorrectedCommands& result, nlohmann::ordered_json& json) {
  if (!result.workpiece || result.poses.count() == 0) return;
  const auto [low, high] = workpiece_temperatures(result);
  add_workpiece(result.machine, *result.workpiece, low, high, json);
}

}  // namespace

CorrectedCommands correct_commands(const CommandsRequest& request) {
  const std::size_t missing = missing_state(request.machine, request.errors.errors, request.poses);
  if (missing != kNoState) {
    throw InputError({.field = state_column(request.machine.states[missing])},
                     "the errors depend on this state, and the poses do not give it", "a column with this name");
  }
  if (request.leave_out_factor != 0) {
    refuse_couplings(request.machine, "--leave-out-below-uncertainty", request.machine_file);
    refuse_states(request.machine, request.errors.errors, "what leaves out errors");
  }
  check_leave_out(request.leave_out_factor, request.errors.errors, request.errors.covariance, request.errors_file);
  if (request.workpiece) require_workpiece_temperature(request);
  const double limit_um = refusal_limit("--limit-um", request.limit_um, "um");
  if (request.largest_turn) check_largest_turn(*request.largest_turn);
  CorrectedCommands result;
  result.machine = request.machine;
  result.poses = request.poses;
  result.leave_out_factor = request.leave_out_factor;
  result.at_state = request.errors.at_state;
  for (std::string& sentence : states_outside_covered(request.machine, request.errors, request.poses)) {
    result.at_state.outside.push_back(std::move(sentence));
  }
  result.workpiece = request.workpiece;
  result.has_reversals = !request.errors.errors.reversals.empty();
  result.corrected = corrected_poses(request.machine, request.errors.errors, request.errors.covariance, request.poses,
                                     {.largest_turn = request.largest_turn,
                                      .leave_out_factor = request.leave_out_factor,
                                      .held = request.held,
                                      .workpiece = request.workpiece});
  const CorrectedPoses& corrected = result.corrected;
  if (!corrected.problem.empty()) throw InputError({.file = request.machine_file}, corrected.problem);
  if (!(1e3 * corrected.largest_shift.value <= limit_um)) {
    result.refused =
        fmt::format("correction of {:.3f} um above --limit-um {:g}: {}", 1e3 * corrected.largest_shift.value, limit_um,
                    pose_words(request.machine, request.poses, corrected.largest_shift.row));
  }
  result.not_reached =
      static_cast<std::size_t>(std::count_if(corrected.status.begin(), corrected.status.end(),
                                             [](CorrectionStatus status) { return !reaches_point(status); }));
  return result;
}

std::string corrected_commands_csv(const CorrectedCommands& result) {
  return poses_csv(result.machine, result.corrected);
}

std::string corrected_commands_text(const CorrectedCommands& result) {
  std::string text = state_line(result.at_state) + workpiece_line_of(result);
  text += poses_text(result.machine, result.poses, result.corrected, result.leave_out_factor);
  if (result.has_reversals) text += "reversal values are not in these commands: a pose has no direction of approach\n";
  return text;
}

nlohmann::ordered_json corrected_commands_json(const CorrectedCommands& result, const std::string& output,
                                               bool written) {
  nlohmann::ordered_json json = poses_json(result.machine, result.poses, result.corrected, output, written);
  add_state(result.at_state, json);
  add_workpiece_of(result, json);
  return json;
}

}  // namespace abbe
