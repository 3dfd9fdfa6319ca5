#include "abbe/formats/machine/workpiece_option.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "abbe/formats/machine/expansion_fields.h"
#include "abbe/formats/machine/state_option.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/machine/state.h"
#include "abbe/verify/thermal/length_temperature.h"

namespace abbe {
namespace {

constexpr const char* kExpansionOption = "--workpiece-expansion-um-per-m-K";
constexpr double kMostKelvin = 1000;

void refuse_out_of_range(const char* option, double value, double least, double most, const char* unit) {
  if (std::isfinite(value) && value >= least && value <= most) return;
  throw InputError({.field = option}, "out of range", fmt::format("{:g} to {:g} {}", least, most, unit));
}

std::size_t temperature_of(const Machine& machine, const std::string& name) {
  const std::size_t state = find_state(machine, name);
  if (state == kNoState) {
    throw InputError({.field = "--workpiece-state " + name}, "the machine has no such state",
                     "a measured state with the unit degC in the machine file");
  }
  const MachineState& one = machine.states[state];
  if (!is_input(one.kind) || one.unit != "degC") {
    throw InputError({.field = "--workpiece-state " + name}, "is not a temperature",
                     "a measured state with the unit degC, or a lag of one");
  }
  if (one.reference != kReferenceTemperature) {
    throw InputError(
        {.field = "--workpiece-state " + name},
        fmt::format("its reference is {:g} degC, and parts are to be right at 20 degC (ISO 1)", one.reference),
        "reference_degC = 20 in the machine file");
  }
  return state;
}

/// Puts the value of --state into poses that have no column of it.
void give_temperature(const Machine& machine, std::size_t state, const std::vector<std::string>& states,
                      PoseList& poses) {
  const std::string column = state_column(machine.states[state]);
  std::vector<std::string> of_workpiece;
  std::copy_if(states.begin(), states.end(), std::back_inserter(of_workpiece),
               [&](const std::string& text) { return text.starts_with(column + "="); });
  poses.state.resize(machine.states.size());
  std::vector<double>& values = poses.state[state];
  if (of_workpiece.empty()) {
    if (!values.empty() && std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); })) return;
    throw InputError({.field = column}, "the temperature of the workpiece is not given at all poses",
                     fmt::format("a column with this name, or --state {}=VALUE", column));
  }
  if (!values.empty()) {
    throw InputError({.field = "--state " + of_workpiece.front()}, "is a column of the poses too", "only one of them");
  }
  values.assign(poses.count(), state_options(machine, "--state", of_workpiece)[state]);
}

}  // namespace

bool WorkpieceOptions::any() const {
  return expansion || u_expansion || u_kelvin || !state.empty() || !fixed_mm.empty();
}

std::optional<WorkpieceExpansion> workpiece_option(const Machine& machine, const WorkpieceOptions& options,
                                                   const std::vector<std::string>& states, PoseList& poses) {
  if (!options.any()) return std::nullopt;
  if (!options.expansion) {
    throw InputError({.field = kExpansionOption}, "is missing", "a coefficient, for the other options of a workpiece");
  }
  if (options.state.empty()) {
    throw InputError({.field = "--workpiece-state"}, "is missing", "the state that is the workpiece's temperature");
  }
  refuse_out_of_range(kExpansionOption, *options.expansion, -1e6 * kLargestExpansion, 1e6 * kLargestExpansion,
                      "um/(m K)");
  WorkpieceExpansion expansion;
  expansion.coefficient = 1e-6 * *options.expansion;
  const double u_expansion = options.u_expansion.value_or(0), u_kelvin = options.u_kelvin.value_or(0);
  refuse_out_of_range("--u-workpiece-expansion-um-per-m-K", u_expansion, 0, 1e6 * kLargestExpansion, "um/(m K)");
  refuse_out_of_range("--u-workpiece-temperature-K", u_kelvin, 0, kMostKelvin, "K");
  expansion.standard_uncertainty = 1e-6 * u_expansion;
  expansion.temperature_uncertainty = u_kelvin;
  if (!options.fixed_mm.empty()) {
    if (options.fixed_mm.size() != 3) {
      throw InputError({.field = "--workpiece-fixed-mm"}, "is not a point", "three coordinates, workpiece frame, mm");
    }
    for (const double value : options.fixed_mm) refuse_out_of_range("--workpiece-fixed-mm", value, -1e6, 1e6, "mm");
    expansion.fixed_point = {options.fixed_mm[0], options.fixed_mm[1], options.fixed_mm[2]};
  }
  expansion.state = temperature_of(machine, options.state);
  give_temperature(machine, expansion.state, states, poses);
  return expansion;
}

}  // namespace abbe
