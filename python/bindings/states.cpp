#include "bindings/states.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <cmath>
#include <string>

#include "abbe/errors/error_states.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/machine/state.h"

namespace abbe::python {
namespace {

/// A state and the machine that it belongs to, of which it needs the names of axes and of other states.
struct NamedState {
  MachineState state;
  std::string column, factor_unit;
  std::optional<std::string> axis, first, second;
};

bool is_given(const MachineState& state) { return is_input(state.kind) || state.kind == StateKind::approach; }

/// Name under which values of a state are given: that of its column, of an approach the name alone.
std::string given_name(const MachineState& state) {
  return state.kind == StateKind::approach ? state.name : state_column(state);
}

std::size_t state_of(const Machine& machine, const std::string& name) {
  std::vector<std::string> names;
  for (std::size_t j = 0; j < machine.states.size(); ++j) {
    if (!is_given(machine.states[j])) continue;
    if (given_name(machine.states[j]) == name) return j;
    names.push_back(given_name(machine.states[j]));
  }
  throw InputError({.field = "states"}, fmt::format("'{}' is no state of the machine that is given", name),
                   names.empty() ? "a machine with states" : fmt::format("{}", fmt::join(names, ", ")));
}

/// Values of one state at all poses: one number for all, or one for each.
std::vector<double> column_of(const ArrayLike& argument, const MachineState& state, std::size_t poses) {
  const std::string field = "states['" + given_name(state) + "']";
  const Numbers numbers = argument.numbers(field.c_str());
  if (numbers.ndim() > 1 || (numbers.ndim() == 1 && numbers.shape(0) != poses)) {
    throw InputError({.field = field}, "is not one value for each pose", fmt::format("a number, or {} of them", poses));
  }
  std::vector<double> values(poses);
  for (std::size_t k = 0; k < poses; ++k) {
    values[k] = numbers.data()[numbers.ndim() == 0 ? 0 : static_cast<std::int64_t>(k) * numbers.stride(0)];
    if (!std::isfinite(values[k])) {
      throw InputError({.field = field}, fmt::format("pose {}: {}", k, values[k]), "finite numbers");
    }
    if (state.kind == StateKind::approach && values[k] != -1 && values[k] != 0 && values[k] != 1) {
      throw InputError({.field = field}, fmt::format("pose {}: {}", k, values[k]), "-1, 1, or 0 where it is not known");
    }
  }
  return values;
}

std::vector<NamedState> states_of(const Machine& machine) {
  std::vector<NamedState> result;
  for (std::size_t j = 0; j < machine.states.size(); ++j) {
    const MachineState& state = machine.states[j];
    NamedState& named = result.emplace_back();
    named.state = state;
    named.column = given_name(state);
    named.factor_unit = factor_unit(machine, j);
    if (state.kind == StateKind::axis || state.kind == StateKind::approach || state.kind == StateKind::gravity) {
      named.axis = machine.axes[state.axis].name;
    }
    if (state.first != kNoState) named.first = machine.states[state.first].name;
    if (state.second != kNoState) named.second = machine.states[state.second].name;
  }
  return result;
}

}  // namespace

GivenColumns::GivenColumns(const StatesArgument& states, const Machine& machine, const ErrorSet& errors,
                           std::size_t poses)
    : machine_(machine) {
  if (states) {
    values_.resize(machine.states.size());
    for (const auto& [key, value] : *states) {
      std::string name;
      if (!nb::try_cast(key, name)) throw InputError({.field = "states"}, "a key is no text", "names of states");
      const std::size_t state = state_of(machine, name);
      values_[state] = column_of(ArrayLike{value}, machine.states[state], poses);
    }
  }
  if (!has_states(errors)) return;
  const std::vector<std::uint8_t> used = used_states(machine, errors);
  for (std::size_t j = 0; j < used.size(); ++j) {
    if (used[j] == 0 || !is_input(machine.states[j].kind) || (!values_.empty() && !values_[j].empty())) continue;
    if (poses == 0) continue;
    throw InputError({.field = "states"},
                     fmt::format("the errors depend on {}, and no value is given", machine.states[j].name),
                     fmt::format("states={{'{}': values}}, or errors.at_state()", given_name(machine.states[j])));
  }
}

std::span<const double* const> GivenColumns::from(std::size_t first, std::vector<const double*>& memory) const {
  memory.resize(values_.size());
  for (std::size_t j = 0; j < values_.size(); ++j) memory[j] = values_[j].empty() ? nullptr : values_[j].data() + first;
  return memory;
}

void GivenColumns::put_into(PoseList& poses) const {
  if (values_.empty()) return;
  poses.state.resize(values_.size());
  for (std::size_t j = 0; j < values_.size(); ++j) {
    const MachineState& state = machine_.states[j];
    if (values_[j].empty()) continue;
    if (is_input(state.kind)) {
      poses.state[j] = values_[j];
      continue;
    }
    poses.approach.resize(poses.axis.size());
    for (std::vector<std::int8_t>& sides : poses.approach) sides.resize(poses.count());
    for (std::size_t k = 0; k < poses.count(); ++k) {
      poses.approach[state.axis][k] = static_cast<std::int8_t>(values_[j][k]);
    }
  }
}

void require_no_given_states(const MachineErrors& errors) {
  const std::vector<std::uint8_t> used = used_states(errors.machine, errors.set());
  for (std::size_t j = 0; j < used.size(); ++j) {
    if (used[j] == 0 || !is_input(errors.machine.states[j].kind)) continue;
    throw InputError({.field = "errors"}, fmt::format("depend on {}", errors.machine.states[j].name),
                     fmt::format("errors.at_state({{'{}': value}})", given_name(errors.machine.states[j])));
  }
}

void bind_states(nb::module_& module) {
  nb::class_<NamedState>(module, "MachineState", "Something that errors of a machine depend on: docs/conventions.md.")
      .def_prop_ro(
          "name", [](const NamedState& s) { return s.state.name; }, "As errors name it: 'EXX*ambient[P1]'.")
      .def_prop_ro(
          "kind", [](const NamedState& s) { return state_kind_name(s.state.kind); },
          "'measured', 'lag', 'axis', 'approach', 'gravity' or 'product'.")
      .def_ro("column", &NamedState::column, "Its name in files of readings and in `states`: 'ambient_degC'.")
      .def_prop_ro(
          "unit", [](const NamedState& s) { return s.state.unit; }, "Of a measured or lag state: 'degC'; else empty.")
      .def_ro("factor_unit", &NamedState::factor_unit, "Of the value less its reference: 'K'.")
      .def_prop_ro(
          "reference", [](const NamedState& s) { return s.state.reference; }, "Value at which its errors are zero.")
      .def_prop_ro(
          "time_constant_s", [](const NamedState& s) { return s.state.time_constant; }, "Of a lag; else 0.")
      .def_ro("axis", &NamedState::axis, "Axis of a state of the kinds axis, approach and gravity; else None.")
      .def_ro("first", &NamedState::first, "State behind which a lag is; first factor of a product; else None.")
      .def_ro("second", &NamedState::second, "Second factor of a product; else None.")
      .def("__repr__", [](const NamedState& s) {
        return fmt::format("<abbe.MachineState {}: {}{}{}>", s.state.name, state_kind_name(s.state.kind),
                           s.state.unit.empty() ? "" : ", ", s.state.unit);
      });
}

void add_states(nb::class_<Machine>& machine) {
  machine.def_prop_ro("states", &states_of, nb::sig("def states(self) -> list[MachineState]"),
                      "States that its errors may depend on, in the order of the machine file.");
}

}  // namespace abbe::python
