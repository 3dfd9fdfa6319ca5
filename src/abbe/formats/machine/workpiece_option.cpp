#include "abbe/formats/machine/workpiece_option.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "abbe/compensate/correction_uncertainty.h"
#include "abbe/errors/expansion.h"
#include "abbe/formats/machine/expansion_fields.h"
#include "abbe/formats/machine/state_option.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/machine/state.h"

namespace abbe {
namespace {

constexpr const char* kExpansionOption = "--workpiece-expansion-um-per-m-K";
constexpr const char* kTemperatureOption = "--workpiece-temperature-degC";
constexpr double kMostKelvin = 1000, kColdest = -273.15;

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

/// Values of --state for one column.
std::vector<std::string> states_of_column(const std::vector<std::string>& states, const std::string& column) {
  std::vector<std::string> of_workpiece;
  std::copy_if(states.begin(), states.end(), std::back_inserter(of_workpiece),
               [&](const std::string& text) { return text.starts_with(column + "="); });
  return of_workpiece;
}

/// Puts the value of --state into poses that have no column of it.
void give_temperature(const Machine& machine, std::size_t state, const std::vector<std::string>& states,
                      PoseList& poses) {
  const std::string column = state_column(machine.states[state]);
  const std::vector<std::string> of_workpiece = states_of_column(states, column);
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

/// What the options state but where the temperature comes from; without options nothing. @throws InputError
std::optional<WorkpieceExpansion> stated_expansion(const WorkpieceOptions& options) {
  if (!options.any()) return std::nullopt;
  if (!options.expansion) {
    throw InputError({.field = kExpansionOption}, "is missing", "a coefficient, for the other options of a workpiece");
  }
  if (options.state.empty() && !options.temperature) {
    throw InputError({.field = "--workpiece-state"}, "is missing",
                     std::string("the state that is the workpiece's temperature, or ") + kTemperatureOption);
  }
  if (!options.state.empty() && options.temperature) {
    throw InputError({.field = kTemperatureOption}, "is given together with --workpiece-state", "only one of them");
  }
  refuse_out_of_range(kExpansionOption, *options.expansion, -1e6 * kLargestExpansion, 1e6 * kLargestExpansion,
                      "um/(m K)");
  WorkpieceExpansion expansion;
  expansion.coefficient = 1e-6 * *options.expansion;
  const double u_expansion = options.u_expansion.value_or(0), u_kelvin = options.u_kelvin.value_or(0);
  refuse_out_of_range("--u-workpiece-expansion-um-per-m-K", u_expansion, 0, 1e6 * kLargestExpansion, "um/(m K)");
  refuse_out_of_range("--u-workpiece-temperature-K", u_kelvin, 0, kMostKelvin, "K");
  if (options.temperature) {
    refuse_out_of_range(kTemperatureOption, *options.temperature, kColdest, kMostKelvin, "degC");
    expansion.temperature = options.temperature;
  }
  expansion.standard_uncertainty = 1e-6 * u_expansion;
  expansion.temperature_uncertainty = u_kelvin;
  if (!options.fixed_mm.empty()) {
    if (options.fixed_mm.size() != 3) {
      throw InputError({.field = "--workpiece-fixed-mm"}, "is not a point", "three coordinates, workpiece frame, mm");
    }
    for (const double value : options.fixed_mm) refuse_out_of_range("--workpiece-fixed-mm", value, -1e6, 1e6, "mm");
    expansion.fixed_point = {options.fixed_mm[0], options.fixed_mm[1], options.fixed_mm[2]};
  }
  return expansion;
}

}  // namespace

std::span<const WorkpieceNumber> workpiece_numbers() {
  using Options = WorkpieceOptions;
  static constexpr auto numbers = std::to_array<WorkpieceNumber>({
      {kExpansionOption, &Options::expansion,
       "Expansion coefficient of a workpiece that must have the right size at 20 degC but has another temperature"},
      {"--u-workpiece-expansion-um-per-m-K", &Options::u_expansion, "Standard uncertainty of that coefficient"},
      {kTemperatureOption, &Options::temperature,
       "Temperature of the workpiece, the same everywhere; or --workpiece-state"},
      {"--u-workpiece-temperature-K", &Options::u_kelvin, "Standard uncertainty of its temperature, K"},
  });
  return numbers;
}

bool WorkpieceOptions::any() const {
  return expansion || u_expansion || u_kelvin || temperature || !state.empty() || !fixed_mm.empty();
}

std::optional<WorkpieceExpansion> workpiece_option(const Machine& machine, const WorkpieceOptions& options,
                                                   const std::vector<std::string>& states, PoseList& poses) {
  std::optional<WorkpieceExpansion> expansion = stated_expansion(options);
  if (!expansion || expansion->temperature) return expansion;
  expansion->state = temperature_of(machine, options.state);
  give_temperature(machine, expansion->state, states, poses);
  return expansion;
}

std::optional<WorkpieceExpansion> workpiece_option(const Machine& machine, const WorkpieceOptions& options,
                                                   const std::vector<std::string>& states) {
  std::optional<WorkpieceExpansion> expansion = stated_expansion(options);
  if (!expansion || expansion->temperature) return expansion;
  const std::size_t state = temperature_of(machine, options.state);
  const std::string column = state_column(machine.states[state]);
  const double value = state_options(machine, "--state", states_of_column(states, column))[state];
  if (!std::isfinite(value)) {
    throw InputError({.field = column}, "the temperature of the workpiece is not given",
                     fmt::format("--state {}=VALUE, or {} instead of --workpiece-state", column, kTemperatureOption));
  }
  expansion->temperature = value;
  return expansion;
}

WorkpieceErrors workpiece_errors(const Machine& machine, const WorkpieceExpansion& workpiece, const ErrorSet& errors) {
  if (errors.composition != Composition{}) {
    throw InputError({.field = "composition"},
                     "a workpiece's expansion is added to errors that are composed as in ISO 230 only",
                     "errors without a table [composition]");
  }
  if (!workpiece.temperature || !std::isfinite(*workpiece.temperature)) {
    throw InputError({.field = kTemperatureOption}, "is missing", "the temperature of the workpiece");
  }
  return {machine, workpiece, *workpiece.temperature - kReferenceTemperature};
}

ErrorsOnWorkpiece errors_on_workpiece(const Machine& machine, const WorkpieceExpansion& workpiece,
                                      const ErrorSet& errors, const Eigen::MatrixXd& covariance) {
  const WorkpieceErrors of_workpiece = workpiece_errors(machine, workpiece, errors);
  return {of_workpiece.with(errors),
          of_workpiece.covariance_with(errors, covariance.size() > 0 ? covariance : stated_variances(errors))};
}

}  // namespace abbe
