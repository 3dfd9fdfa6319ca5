#include "abbe/formats/machine/machine_states.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "abbe/formats/machine/error_fields.h"
#include "abbe/formats/text/toml_vector.h"

namespace abbe {
namespace {

/// A name of an axis of the machine under a key.
std::size_t axis_named(TomlTable& table, std::string_view key, const Machine& machine) {
  const std::string name = table.text(key);
  const std::size_t axis = machine.find_axis(name);
  if (axis == Machine::npos)
    table.fail(key, fmt::format("\"{}\" is not an axis of this machine", name), axis_names(machine));
  return axis;
}

std::size_t state_named(const TomlTable& table, std::string_view key, const std::string& name,
                        const std::vector<std::string>& names) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) {
    table.fail(key, fmt::format("\"{}\" is not a state of this machine", name),
               fmt::format("{}", fmt::join(names, ", ")));
  }
  return static_cast<std::size_t>(found - names.begin());
}

std::string read_state_unit(TomlTable& table) {
  const std::string unit = table.text("unit");
  if (std::find(std::begin(kStateUnits), std::end(kStateUnits), unit) == std::end(kStateUnits)) {
    table.fail("unit", fmt::format("\"{}\" is not a unit of states", unit),
               fmt::format("{}", fmt::join(std::begin(kStateUnits), std::end(kStateUnits), ", ")));
  }
  return unit;
}

GravityLoad read_load(TomlTable& table, const Machine& machine) {
  GravityLoad load;
  const std::string carrier = table.text("carried_by");
  const std::size_t workpiece_axes = machine.workpiece_axis_count();
  // Both ends of the chain may be named: what hangs there is carried by their last axis.
  if (carrier == "tool" && workpiece_axes < machine.axes.size()) {
    load.carried_by = machine.axes.size() - 1;
  } else if (carrier == "workpiece" && workpiece_axes > 0) {
    load.carried_by = 0;
  } else {
    load.carried_by = axis_named(table, "carried_by", machine);
  }
  load.mass_kg = table.number("mass_kg", Quantity::dimensionless);
  if (!(load.mass_kg > 0)) table.fail("mass_kg", "is not above zero", "a mass in kg");
  load.point = vector_of(table.numbers("point", Quantity::length, 3));
  table.finish();
  return load;
}

/// "reference_degC"
std::string reference_key(const MachineState& state) {
  return state.unit == "1" ? "reference" : "reference_" + state.unit;
}

void read_state(TomlTable table, const Machine& machine, const std::vector<std::string>& names, MachineState& state) {
  state.kind =
      static_cast<StateKind>(table.word("kind", {"measured", "lag", "axis", "approach", "gravity", "product"}));
  switch (state.kind) {
    case StateKind::measured: {
      state.unit = read_state_unit(table);
      const double usual = state.unit == "degC" ? 20 : 0;  // ISO 1: the reference temperature
      state.reference = table.number_or(reference_key(state), Quantity::dimensionless, usual);
      break;
    }
    case StateKind::lag:
      state.first = state_named(table, "of", table.text("of"), names);
      state.time_constant = table.number("time_constant", Quantity::time);
      if (!(state.time_constant > 0)) {
        table.fail_quantity("time_constant", Quantity::time, "is not above zero", "a time constant");
      }
      break;
    case StateKind::axis:
      state.axis = axis_named(table, "axis", machine);
      state.reference = table.number_or("reference", axis_quantity(machine.axes[state.axis]), 0);
      break;
    case StateKind::approach:
      state.axis = axis_named(table, "axis", machine);
      break;
    case StateKind::gravity:
      state.axis = axis_named(table, "about", machine);
      for (TomlTable& load : table.tables("load")) state.loads.push_back(read_load(load, machine));
      if (state.loads.empty()) table.fail("load", "is missing", "at least one [[state.NAME.load]] with its mass_kg");
      break;
    case StateKind::product: {
      const std::vector<std::string> factors = table.texts("of");
      if (factors.size() != 2) table.fail("of", "does not name two states", "of = [\"payload\", \"torque\"]");
      state.first = state_named(table, "of", factors[0], names);
      state.second = state_named(table, "of", factors[1], names);
      break;
    }
  }
  table.finish();
}

std::string state_text(const Machine& machine, const MachineState& state) {
  std::string text = fmt::format("\n[state.{}]\nkind = \"{}\"\n", state.name, state_kind_name(state.kind));
  const auto axis = [&](const char* key) {
    text += fmt::format("{} = {}\n", key, toml_string(machine.axes[state.axis].name));
  };
  switch (state.kind) {
    case StateKind::measured:
      text += fmt::format("unit = \"{}\"\n{} = {}\n", state.unit, reference_key(state), shortest_text(state.reference));
      break;
    case StateKind::lag:
      text += fmt::format("of = \"{}\"\ntime_constant_s = {}\n", machine.states[state.first].name,
                          shortest_text(state.time_constant));
      break;
    case StateKind::axis:
      axis("axis");
      text += machine.axes[state.axis].kind == AxisKind::rotary
                  ? toml_angles("reference", {state.reference}, true)
                  : fmt::format("reference_mm = {}\n", shortest_text(state.reference));
      break;
    case StateKind::approach:
      axis("axis");
      break;
    case StateKind::gravity:
      axis("about");
      for (const GravityLoad& load : state.loads) {
        text += fmt::format("[[state.{}.load]]\ncarried_by = {}\nmass_kg = {}\npoint_mm = {}\n", state.name,
                            toml_string(machine.axes[load.carried_by].name), shortest_text(load.mass_kg),
                            vector_text(load.point));
      }
      break;
    case StateKind::product:
      text +=
          fmt::format("of = [\"{}\", \"{}\"]\n", machine.states[state.first].name, machine.states[state.second].name);
      break;
  }
  return text;
}

}  // namespace

std::string vector_text(const Eigen::Vector3d& v) {
  return fmt::format("[{}, {}, {}]", shortest_text(v.x()), shortest_text(v.y()), shortest_text(v.z()));
}

void read_states(TomlTable& root, Machine& machine) {
  if (const auto gravity = root.optional_numbers("gravity_m_per_s2", Quantity::dimensionless, 3)) {
    machine.gravity = vector_of(*gravity);
  }
  auto states = root.optional_table("state");
  if (!states) return;
  const std::vector<std::string> names = states->keys();
  for (const std::string& name : names) {
    MachineState state;
    state.name = name;
    read_state(states->table(name), machine, names, state);
    machine.states.push_back(std::move(state));
  }
  for (MachineState& state : machine.states) {
    if (state.kind != StateKind::lag) continue;
    const MachineState& of = machine.states[state.first];
    if (of.kind != StateKind::measured)
      states->fail(state.name, of.name + " is not a measured state", "of = a measured state");
    state.unit = of.unit;
    state.reference = of.reference;
  }
  states->finish();
}

void fail_state(TomlTable& root, const MachineProblem& problem) {
  const std::string rest = problem.field.substr(std::string_view("state.").size());
  const std::string name = rest.substr(0, rest.find('.'));
  root.table("state").fail(name, problem.text());
}

std::string states_text(const Machine& machine) {
  std::string text;
  for (const MachineState& state : machine.states) text += state_text(machine, state);
  return text;
}

}  // namespace abbe
