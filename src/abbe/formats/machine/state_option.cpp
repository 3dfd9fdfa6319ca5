#include "abbe/formats/machine/state_option.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>

#include "abbe/errors/error_states.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/nearest_word.h"
#include "abbe/formats/text/number_text.h"
#include "abbe/machine/state.h"

namespace abbe {
namespace {

/// "ambient_degC", ... of the states that have to be given.
std::vector<std::string> given_columns(const Machine& machine) {
  std::vector<std::string> columns;
  for (const MachineState& state : machine.states) {
    if (is_input(state.kind)) columns.push_back(state_column(state));
  }
  return columns;
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

}  // namespace

std::vector<double> state_options(const Machine& machine, const std::string& option,
                                  const std::vector<std::string>& texts) {
  std::vector<double> values(machine.states.size(), std::numeric_limits<double>::quiet_NaN());
  const std::vector<std::string> columns = given_columns(machine);
  for (const std::string& text : texts) {
    const auto fail = [&](const std::string& problem, const std::string& expected) {
      throw InputError({.field = option + " " + text}, problem, expected);
    };
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos) fail("not understood", "NAME_unit=value, such as ambient_degC=26.5");
    const std::string name = text.substr(0, equals);
    std::size_t state = 0;
    while (state < values.size() &&
           !(is_input(machine.states[state].kind) && state_column(machine.states[state]) == name)) {
      ++state;
    }
    if (state == values.size()) {
      fail(name_problem(machine, name, columns), columns.empty() ? "states of kind \"measured\" in the machine file"
                                                                 : fmt::format("{}", fmt::join(columns, ", ")));
    }
    if (std::isfinite(values[state])) fail("was given before", "each state once");
    double value = 0;
    switch (parse_number(std::string_view(text).substr(equals + 1), 0, value)) {
      case NumberProblem::none:
        break;
      case NumberProblem::not_a_number:
        fail("not a number", "a value in the unit of the name");
        break;
      case NumberProblem::not_finite:
        fail("not finite", "a value in the unit of the name");
        break;
      case NumberProblem::too_large:
        fail("too large", fmt::format("at most {:g}", kLargestInput));
        break;
    }
    if (!(std::abs(value) <= kLargestInput)) fail("too large", fmt::format("at most {:g}", kLargestInput));
    values[state] = value;
  }
  return values;
}

ErrorsFile at_given_states(const Machine& machine, ErrorsFile file, std::span<const double> values,
                           const std::string& path) {
  const std::vector<std::uint8_t> used = used_states(machine, file.errors);
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

ErrorsFile read_errors_at(const std::filesystem::path& path, const Machine& machine,
                          const std::vector<std::string>& states) {
  const std::vector<double> values = state_options(machine, "--state", states);
  return at_given_states(machine, read_errors(path, machine, StatesOfErrors::allowed), values, path.string());
}

std::string state_words(const StateValues& values) {
  std::string words;
  for (const auto& [column, value] : values) {
    words += fmt::format("{}{} = {}", words.empty() ? "" : ", ", column, shortest_text(value));
  }
  return words;
}

}  // namespace abbe
