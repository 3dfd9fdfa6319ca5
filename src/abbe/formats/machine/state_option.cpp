#include "abbe/formats/machine/state_option.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>

#include "abbe/compensate/correction_uncertainty.h"
#include "abbe/errors/error_states.h"
#include "abbe/errors/expansion.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/nearest_word.h"
#include "abbe/formats/text/number_text.h"
#include "abbe/machine/state.h"

namespace abbe {
namespace {

constexpr std::string_view kAgeOption = "days_since_measurement";

/// "ambient_degC", ... of the states that have to be given.
std::vector<std::string> given_columns(const Machine& machine) {
  std::vector<std::string> columns;
  for (const MachineState& state : machine.states) {
    if (is_input(state.kind)) columns.push_back(state_column(state));
  }
  return columns;
}

/// Option `days_since_measurement=30`, taken out of the others; nothing where it is not given.
std::optional<double> take_age(const std::string& option, std::vector<std::string>& texts) {
  std::optional<double> days;
  for (std::size_t i = 0; i < texts.size();) {
    if (!texts[i].starts_with(kAgeOption) || !std::string_view(texts[i]).substr(kAgeOption.size()).starts_with("=")) {
      ++i;
      continue;
    }
    double value = 0;
    const std::string_view number = std::string_view(texts[i]).substr(kAgeOption.size() + 1);
    if (parse_number(number, 0, value) != NumberProblem::none || !(value >= 0) || value > kLargestInput || days) {
      throw InputError({.field = option + " " + texts[i]}, days ? "was given before" : "not a number of days",
                       "0 or more days, once");
    }
    days = value;
    texts.erase(texts.begin() + static_cast<std::ptrdiff_t>(i));
  }
  return days;
}

/// Values of states and the age among texts of an option; the errors become as old as that says.
std::vector<double> values_and_age(const Machine& machine, const std::string& option, std::vector<std::string> states,
                                   const std::string& path, ErrorsFile& file) {
  const std::optional<double> days = take_age(option, states);
  std::vector<double> values = state_options(machine, option, states);
  if (!days || is_truth(file)) return values;  // the truth is what it is
  if (!file.ageing.any()) {
    throw InputError({.file = path, .field = "ageing"},
                     "the errors file does not state how these errors change with time",
                     "a table [ageing] with um_per_sqrt_day and urad_per_sqrt_day");
  }
  add_ageing(machine, *days, file);
  file.at_state.emplace_back(std::string(kAgeOption), *days);
  return values;
}

/// What is wrong with the name of a state.
std::string name_problem(const Machine& machine, const std::string& name, const std::vector<std::string>& columns) {
  const std::size_t named = find_state(machine, name);
  if (named != kNoState && is_input(machine.states[named].kind)) return "the unit is missing from the name";
  if (named != kNoState) {
    return fmt::format("'{}' is computed at every pose ({})", name, state_kind_name(machine.states[named].kind));
  }
  const std::optional<std::string> near = nearest_word(name, columns);
  return fmt::format("the machine has no state '{}'{}", name,
                     near ? fmt::format(" (did you mean {}?)", *near) : std::string());
}

/// A number of an option. @throws InputError
double option_number(const std::string& field, std::string_view text) {
  double value = 0;
  const auto fail = [&](const char* problem, const std::string& expected) {
    throw InputError({.field = field}, problem, expected);
  };
  switch (parse_number(text, 0, value)) {
    case NumberProblem::none:
      break;
    case NumberProblem::not_a_number:
      fail("not a number", "a value in the unit of the name, with a decimal point");
      break;
    case NumberProblem::not_finite:
      fail("not finite", "a value in the unit of the name");
      break;
    case NumberProblem::too_large:
      fail("too large", fmt::format("at most {:g}", kLargestInput));
      break;
  }
  if (!(std::abs(value) <= kLargestInput)) fail("too large", fmt::format("at most {:g}", kLargestInput));
  return value;
}

/// Index of the given state whose column has this name. @throws InputError
std::size_t state_of_column(const Machine& machine, const std::string& field, const std::string& name) {
  for (std::size_t state = 0; state < machine.states.size(); ++state) {
    if (is_input(machine.states[state].kind) && state_column(machine.states[state]) == name) return state;
  }
  const std::vector<std::string> columns = given_columns(machine);
  throw InputError({.field = field}, name_problem(machine, name, columns),
                   columns.empty() ? "states of kind \"measured\" in the machine file"
                                   : fmt::format("{}", fmt::join(columns, ", ")));
}

}  // namespace

std::vector<double> state_options(const Machine& machine, const std::string& option,
                                  const std::vector<std::string>& texts) {
  std::vector<double> values(machine.states.size(), std::numeric_limits<double>::quiet_NaN());
  for (const std::string& text : texts) {
    const std::string field = option + " " + text;
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos) {
      throw InputError({.field = field}, "not understood", "NAME_unit=value, such as ambient_degC=26.5");
    }
    const std::size_t state = state_of_column(machine, field, text.substr(0, equals));
    if (std::isfinite(values[state])) throw InputError({.field = field}, "was given before", "each state once");
    values[state] = option_number(field, std::string_view(text).substr(equals + 1));
  }
  return values;
}

std::vector<std::optional<std::pair<double, double>>> state_range_options(const Machine& machine,
                                                                          const std::string& option,
                                                                          const std::vector<std::string>& texts) {
  std::vector<std::optional<std::pair<double, double>>> ranges(machine.states.size());
  for (const std::string& text : texts) {
    const std::string field = option + " " + text;
    const std::size_t equals = text.find('='), colon = text.find(':', equals == std::string::npos ? 0 : equals);
    if (equals == std::string::npos || colon == std::string::npos) {
      throw InputError({.field = field}, "not understood", "NAME_unit=FROM:TO, such as ambient_degC=15:30");
    }
    const std::size_t state = state_of_column(machine, field, text.substr(0, equals));
    if (machine.states[state].kind != StateKind::measured) {
      throw InputError({.field = field}, fmt::format("{} is computed from its channel", machine.states[state].name),
                       "the range of a measured state");
    }
    if (ranges[state]) throw InputError({.field = field}, "was given before", "each state once");
    const std::string_view numbers = std::string_view(text).substr(equals + 1);
    const double from = option_number(field, numbers.substr(0, colon - equals - 1));
    const double to = option_number(field, numbers.substr(colon - equals));
    if (!(from < to)) throw InputError({.field = field}, "the range is empty", "the lower end first");
    ranges[state] = std::pair(from, to);
  }
  return ranges;
}

std::vector<std::string> values_outside_covered(const Machine& machine, const ErrorsFile& file,
                                                std::span<const double> values) {
  std::vector<std::string> sentences;
  const std::vector<std::uint8_t> used = used_states(machine, file.errors);
  for (std::size_t j = 0; j < std::min(values.size(), used.size()); ++j) {
    if (used[j] == 0 || !std::isfinite(values[j])) continue;
    const std::string column = state_column(machine.states[j]);
    for (const CoveredState& covered : file.covered) {
      if (covered.column != column || covered.contains(values[j])) continue;
      sentences.push_back(
          fmt::format("{} = {} lies outside the {} to {} that the readings cover: the errors are extrapolated", column,
                      shortest_text(values[j]), shortest_text(covered.from), shortest_text(covered.to)));
    }
  }
  return sentences;
}

std::vector<std::string> states_outside_covered(const Machine& machine, const ErrorsFile& file, const PoseList& poses) {
  std::vector<std::string> sentences;
  const std::vector<std::uint8_t> used = used_states(machine, file.errors);
  for (std::size_t j = 0; j < poses.state.size(); ++j) {
    if (used[j] == 0 || poses.state[j].empty()) continue;
    for (const CoveredState& covered : file.covered) {
      if (covered.column != state_column(machine.states[j])) continue;
      std::size_t outside = 0, worst = 0;
      double furthest = 0;
      for (std::size_t k = 0; k < poses.count(); ++k) {
        const double value = poses.state[j][k];
        const double beyond = std::max(covered.from - value, value - covered.to);
        if (!(beyond > 0)) continue;
        ++outside;
        if (beyond > furthest) {
          furthest = beyond;
          worst = k;
        }
      }
      if (outside == 0) continue;
      sentences.push_back(fmt::format(
          "{} lies outside the {} to {} that the readings cover at {} of {} poses, furthest in row {} ({}): "
          "the errors are extrapolated there",
          covered.column, shortest_text(covered.from), shortest_text(covered.to), outside, poses.count(), worst + 1,
          shortest_text(poses.state[j][worst])));
    }
  }
  return sentences;
}

ErrorsFile at_given_states(const Machine& machine, ErrorsFile file, std::span<const double> values,
                           const std::string& path) {
  const std::vector<std::uint8_t> used = used_states(machine, file.errors);
  for (std::string& sentence : values_outside_covered(machine, file, values))
    file.at_state.outside.push_back(std::move(sentence));
  std::string missing_names, missing_options;
  for (std::size_t j = 0; j < used.size(); ++j) {
    const MachineState& state = machine.states[j];
    if (used[j] == 0 || !is_input(state.kind)) continue;
    if (j < values.size() && std::isfinite(values[j])) {
      file.at_state.emplace_back(state_column(state), values[j]);
      continue;
    }
    missing_names += (missing_names.empty() ? "" : ", ") + state.name;
    missing_options += fmt::format("{}--state {}=VALUE", missing_options.empty() ? "" : " ", state_column(state));
  }
  if (!missing_names.empty()) {
    throw InputError({.file = path}, "the errors depend on " + missing_names + ", and no value is given",
                     missing_options + " for the errors at a state");
  }
  if (file.at_state.empty()) return file;
  Eigen::MatrixXd by_parameters;
  file.errors = at_state(machine, file.errors, values, &by_parameters);
  if (file.covariance.size() > 0) file.covariance = by_parameters * file.covariance * by_parameters.transpose();
  file.provenance.emplace_back("state", state_words(file.at_state));
  return file;
}

void add_ageing(const Machine& machine, double days, ErrorsFile& file) {
  const double seconds = 86400 * days;
  const std::size_t count = file.errors.parameter_count();
  if (file.covariance.size() == 0) file.covariance = stated_variances(file.errors);
  if (file.covariance.size() == 0) {
    file.covariance.setZero(static_cast<Eigen::Index>(count), static_cast<Eigen::Index>(count));
  }
  const std::vector<bool> angles = parameters_are_angles(machine, file.errors);
  std::size_t next = 0;
  const auto wander = [&](bool wanders, double* uncertainty) {
    const double intensity = angles[next] ? file.ageing.angle : file.ageing.length;
    const auto at = static_cast<Eigen::Index>(next++);
    if (!wanders) return;
    file.covariance(at, at) += intensity * intensity * seconds;
    if (uncertainty != nullptr) *uncertainty = std::sqrt(file.covariance(at, at));
  };
  for (std::size_t m = 0; m < file.errors.motions.size(); ++m) {
    ErrorMotion& motion = file.errors.motions[m];
    // What a thermometer is wrong by does not age beside the error motion itself.
    const bool wanders = motion.state == kNoState && !is_expansion_temperature(machine, file.errors, m);
    motion.standard_uncertainty.resize(motion.coefficients.size(), 0.0);
    for (double& u : motion.standard_uncertainty) wander(wanders, &u);
  }
  for (LocationError& location : file.errors.locations) {
    wander(location.state == kNoState, &location.standard_uncertainty);
  }
  for (Reversal& reversal : file.errors.reversals) wander(true, &reversal.standard_uncertainty);
}

ErrorsFile read_errors_and_values(const std::filesystem::path& path, const Machine& machine,
                                  const std::vector<std::string>& states, std::vector<double>& values) {
  ErrorsFile file = read_errors(path, machine, StatesOfErrors::allowed);
  values = values_and_age(machine, "--state", states, path.string(), file);
  return file;
}

ErrorsFile errors_at_options(const Machine& machine, ErrorsFile file, const std::string& option,
                             const std::vector<std::string>& states, const std::string& path,
                             StatesOfErrors not_given) {
  StateValues before = std::exchange(file.at_state, {});
  const std::vector<double> values = values_and_age(machine, option, states, path, file);
  const StateValues age = std::exchange(file.at_state, std::move(before));
  const bool any = std::any_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
  if (any || not_given == StatesOfErrors::refused) file = at_given_states(machine, std::move(file), values, path);
  file.at_state.insert(file.at_state.end(), age.begin(), age.end());
  return file;
}

ErrorsFile read_errors_at(const std::filesystem::path& path, const Machine& machine,
                          const std::vector<std::string>& states, StatesOfErrors not_given) {
  // Options first: what is wrong with them needs no file.
  std::vector<std::string> of_machine = states;
  take_age("--state", of_machine);
  state_options(machine, "--state", of_machine);
  ErrorsFile file = read_errors(path, machine, StatesOfErrors::allowed);
  return errors_at_options(machine, std::move(file), "--state", states, path.string(), not_given);
}

std::string state_words(const StateValues& values) {
  std::string words;
  for (const auto& [column, value] : values) {
    words += fmt::format("{}{} = {}", words.empty() ? "" : ", ", column, shortest_text(value));
  }
  return words;
}

}  // namespace abbe
