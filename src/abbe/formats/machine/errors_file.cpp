#include "abbe/formats/machine/errors_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>

#include "abbe/compensate/correction_uncertainty.h"
#include "abbe/errors/error_states.h"
#include "abbe/errors/expansion.h"
#include "abbe/formats/files/results_folder.h"
#include "abbe/formats/files/text_file.h"
#include "abbe/formats/machine/covariance_file.h"
#include "abbe/formats/machine/error_fields.h"
#include "abbe/formats/machine/expansion_fields.h"
#include "abbe/formats/text/csv_reader.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/number_text.h"
#include "abbe/formats/text/toml_table.h"
#include "abbe/machine/state.h"

namespace abbe {
namespace {

std::string error_name_hint(const Machine& machine) {
  return fmt::format("E, one of X Y Z A B C, and an axis of the machine ({}): EX{}; location errors with 0: EA0{}",
                     axis_names(machine), machine.axes.front().name, machine.axes.front().name);
}

/// Name of an error motion or of a location error. @throws InputError
void read_name(TomlTable& table, const Machine& machine, bool location, std::size_t& axis, Component& component) {
  const std::string name = table.text("name");
  bool is_location = false;
  if (!parse_error_name(machine, name, axis, component, is_location)) {
    table.fail("name", fmt::format("\"{}\" is not an error of this machine", name), error_name_hint(machine));
  }
  if (is_location != location) {
    table.fail("name", fmt::format("\"{}\" is {}", name, is_location ? "a location error" : "an error motion"),
               is_location ? "it under [[location]]" : "it under [[motion]]");
  }
}

/// Whether a job that knows the commands of a pose, or motions that lead to it, needs nothing else for this state.
bool is_usable(const Machine& machine, std::size_t state, UsableStates usable) {
  if (usable == UsableStates::none) return false;
  const MachineState& one = machine.states[state];
  if (one.kind == StateKind::product) {
    return is_usable(machine, one.first, usable) && is_usable(machine, one.second, usable);
  }
  if (one.kind == StateKind::approach) return usable == UsableStates::of_motions;
  return one.kind == StateKind::axis || one.kind == StateKind::gravity;
}

/// Key `state` of an error. @throws InputError
std::size_t read_state_of_error(TomlTable& table, const Machine& machine, StatesOfErrors states) {
  if (!table.has("state")) return kNoState;
  const std::string name = table.text("state");
  const std::size_t state = find_state(machine, name);
  if (state == kNoState) {
    std::string known;
    for (const MachineState& one : machine.states) known += (known.empty() ? "" : ", ") + one.name;
    table.fail("state", fmt::format("\"{}\" is not a state of this machine", name),
               known.empty() ? "a table [state." + name + "] in the machine file" : known);
  }
  if (states == StatesOfErrors::refused) {
    table.fail("state", fmt::format("this error depends on {}, which is not taken into account here", name),
               "errors without states");
  }
  return state;
}

/// Tables `expansion`: error motions like the others, which follow those of the file. @throws InputError
std::vector<ScaleExpansion> read_expansions(TomlTable& root, const Machine& machine, StatesOfErrors states,
                                            ErrorSet& errors) {
  std::vector<ScaleExpansion> expansions;
  for (TomlTable& table : root.tables("expansion")) {
    if (table.has("state")) read_state_of_error(table, machine, states);
    expansions.push_back(read_expansion(table, machine));
    for (std::size_t i = 0; i + 1 < expansions.size(); ++i) {
      if (expansions[i].axis != expansions.back().axis || expansions[i].state != expansions.back().state) continue;
      table.fail("axis", "this axis has an expansion with this state already", "one for each scale");
    }
    const std::vector<ErrorMotion> terms = expansion_terms(machine, expansions.back());
    errors.motions.insert(errors.motions.end(), terms.begin(), terms.end());
  }
  return expansions;
}

/// What no error of an axis is, and from where on a computation need not have a result.
constexpr double kLargestErrorAngle = 0.5 * std::numbers::pi, kLargestErrorLength = 1e5;

void refuse_implausible(const TomlTable& table, std::string_view base, Quantity quantity, double value) {
  const bool is_angle = quantity == Quantity::angle;
  if (std::abs(value) <= (is_angle ? kLargestErrorAngle : kLargestErrorLength)) return;
  table.fail_quantity(base, quantity, "is too large for an error of a machine",
                      is_angle ? "at most 90 deg to either side" : "at most 100 m to either side");
}

void read_uncertainty(TomlTable& table, ErrorMotion& motion) {
  const Quantity quantity = error_quantity(motion.component);
  const auto values = table.optional_numbers("standard_uncertainty", quantity, motion.coefficients.size());
  if (!values) return;
  for (const double value : *values) {
    if (value < 0) table.fail_quantity("standard_uncertainty", quantity, "is negative", "values not below zero");
  }
  motion.standard_uncertainty = *values;
}

/// CSV with the axis position, the error and perhaps its standard uncertainty; fills nodes and coefficients.
void read_table_file(TomlTable& table, const std::filesystem::path& folder, const Machine& machine,
                     ErrorMotion& motion) {
  const std::string name = table.text("table");
  const std::filesystem::path path = folder / name;
  const Axis& axis = machine.axes[motion.axis];
  const std::string error = error_motion_name(machine, motion.axis, motion.component);
  const Quantity quantity = error_quantity(motion.component);
  ColumnMapping mapping;
  mapping.ignore = table.texts_or_none("ignore");
  mapping.ignored_by = "`ignore`";
  const std::vector<CsvColumn> wanted = {{axis.name, axis_quantity(axis)},
                                         {error, quantity},
                                         {"u_" + error, quantity, false, false, CsvColumn::Range::not_negative}};
  const MappedFile file(path);
  CsvTable csv = read_csv(file.text(), path.string(), wanted, mapping);
  motion.basis.nodes = std::move(csv.columns[0].numbers);
  motion.coefficients = std::move(csv.columns[1].numbers);
  motion.standard_uncertainty = std::move(csv.columns[2].numbers);
  for (std::size_t i = 1; i < motion.basis.nodes.size(); ++i) {
    if (motion.basis.nodes[i] > motion.basis.nodes[i - 1]) continue;
    throw InputError({path.string(), csv_line(file.text(), i), 0, csv.columns[0].header},
                     "is not larger than in the row before", "increasing positions");
  }
}

/// Nodes and values of a table, from a file or inline.
void read_table(TomlTable& table, const std::filesystem::path& folder, const Machine& machine, ErrorMotion& motion) {
  const Axis& axis = machine.axes[motion.axis];
  std::vector<double>& nodes = motion.basis.nodes;
  if (table.has("table")) {
    read_table_file(table, folder, machine, motion);
  } else {
    nodes = table.numbers("at", axis_quantity(axis));
    motion.coefficients = table.numbers("coefficients", error_quantity(motion.component), nodes.size());
    for (const double value : motion.coefficients) {
      refuse_implausible(table, "coefficients", error_quantity(motion.component), value);
    }
    read_uncertainty(table, motion);
  }
  table.text_or("table", "");
  for (std::size_t i = 1; i < nodes.size(); ++i) {
    if (!(nodes[i] > nodes[i - 1])) table.fail_quantity("at", axis_quantity(axis), "is not increasing");
  }
  if (nodes.size() < 2) table.fail("", "the table has fewer than two rows", "two or more positions");
  motion.basis.from = nodes.front();
  motion.basis.to = nodes.back();
  if (motion.basis.periodic && !(nodes.back() - nodes.front() < motion.basis.period)) {
    table.fail_quantity("period", axis_quantity(axis), "is not longer than the table",
                        "the first position one period later is not in the table");
  }
}

void read_values(TomlTable& table, const std::filesystem::path& folder, const Machine& machine, ErrorMotion& motion) {
  motion.basis = read_basis_kind(table);
  if (!is_table(motion.basis.kind)) {
    motion.basis.order = static_cast<int>(table.integer("order", smallest_order(motion.basis), kLargestOrder));
  }
  read_basis_range(table, machine, motion.axis, motion.basis);
  if (is_table(motion.basis.kind)) {
    read_table(table, folder, machine, motion);
  } else {
    motion.coefficients = table.numbers("coefficients", error_quantity(motion.component), motion.basis.size());
    for (const double value : motion.coefficients) {
      refuse_implausible(table, "coefficients", error_quantity(motion.component), value);
    }
    read_uncertainty(table, motion);
  }
}

std::string list_text(const std::vector<double>& values, const Unit& unit) {
  std::string list;
  for (const double value : values) list += (list.empty() ? "" : ", ") + quantity_text(value, unit);
  return "[" + list + "]";
}

const Unit& error_unit(Component component) {
  return unit_named(error_quantity(component), is_rotation(component) ? "urad" : "um");
}

/// What is written of a state: nothing without one.
std::string state_line(const Machine& machine, std::size_t state) {
  if (state == kNoState) return {};
  const std::string unit = factor_unit(machine, state);
  return fmt::format("state = {}{}\n", toml_string(machine.states[state].name),
                     unit == "1" ? "" : "  # coefficients and values are per " + unit);
}

std::string motion_text(const Machine& machine, const ErrorMotion& motion) {
  const Axis& axis = machine.axes[motion.axis];
  const Unit& unit = error_unit(motion.component);
  std::string text = fmt::format(
      "\n[[motion]]\nname = \"{}\"{}\n{}{}", error_motion_name(machine, motion.axis, motion.component),
      expansion_comment(machine, motion), state_line(machine, motion.state), basis_text(motion.basis, axis));
  if (is_table(motion.basis.kind)) {
    text += axis.kind == AxisKind::rotary
                ? toml_angles("at", motion.basis.nodes)
                : fmt::format("at_mm = {}\n", list_text(motion.basis.nodes, unit_named(Quantity::length, "mm")));
  }
  text += fmt::format("coefficients_{} = {}\n", unit.suffix, list_text(motion.coefficients, unit));
  if (!motion.standard_uncertainty.empty()) {
    text += fmt::format("standard_uncertainty_{} = {}\n", unit.suffix, list_text(motion.standard_uncertainty, unit));
  }
  return text;
}

}  // namespace

namespace {

constexpr double kSecondsOfHour = 3600, kSecondsOfDay = 86400;

/// Table `covered`: the states over which the readings were taken, and the time.
void read_covered(TomlTable& table, const Machine& machine, ErrorsFile& contents) {
  contents.covered_time_s = table.size_or("time_span", Quantity::time, 0);
  for (const MachineState& state : machine.states) {
    const std::string column = state_column(state);
    if (!is_input(state.kind) || !table.has(column)) continue;
    const std::vector<double> range = table.numbers(column, Quantity::dimensionless, 2);
    if (range[1] < range[0]) table.fail(column, "is not a range", "[smallest, largest]");
    contents.covered.push_back({column, range[0], range[1]});
  }
  table.finish();
}

/// Table `ageing`.
void read_ageing(TomlTable& table, ErrorsFile& contents) {
  const double per_root = 1 / std::sqrt(kSecondsOfDay);
  contents.ageing.length = 1e-3 * per_root * table.size_or("um_per_sqrt_day", Quantity::dimensionless, 0);
  contents.ageing.angle = 1e-6 * per_root * table.size_or("urad_per_sqrt_day", Quantity::dimensionless, 0);
  table.finish();
}

std::string covered_text(const ErrorsFile& contents) {
  std::string text;
  if (!contents.covered.empty()) text += "\n[covered]  # of what the readings cover\n";
  if (!contents.covered.empty() && contents.covered_time_s > 0) {
    text += fmt::format("time_span_h = {}\n", shortest_text(contents.covered_time_s / kSecondsOfHour));
  }
  for (const CoveredState& state : contents.covered) {
    text += fmt::format("{} = [{}, {}]\n", state.column, shortest_text(state.from), shortest_text(state.to));
  }
  if (!contents.ageing.any()) return text;
  const double root = std::sqrt(kSecondsOfDay);
  // Without the last digit, which conversion to and from seconds does not keep.
  text += fmt::format("\n[ageing]\num_per_sqrt_day = {:.15g}\nurad_per_sqrt_day = {:.15g}\n",
                      1e3 * root * contents.ageing.length, 1e6 * root * contents.ageing.angle);
  return text;
}

}  // namespace

ErrorsFile parse_errors(const std::string& text, const std::filesystem::path& path, const Machine& machine,
                        StatesOfErrors states) {
  TomlTable root = TomlTable::parse(text, path.string());
  const std::filesystem::path folder = path.parent_path();
  ErrorsFile contents;
  ErrorSet& errors = contents.errors;

  const std::string chain = root.text_or("chain", machine.chain());
  if (chain != machine.chain()) {
    root.fail("chain", fmt::format("the errors belong to \"{}\"", chain), fmt::format("\"{}\"", machine.chain()));
  }
  for (TomlTable& table : root.tables("motion")) {
    ErrorMotion motion;
    read_name(table, machine, false, motion.axis, motion.component);
    motion.state = read_state_of_error(table, machine, states);
    read_values(table, folder, machine, motion);
    table.finish();
    errors.motions.push_back(std::move(motion));
  }
  const std::size_t first_expansion = errors.parameters().size() - 3;  // the last are those of the tool offset
  const std::vector<ScaleExpansion> expansions = read_expansions(root, machine, states, errors);
  for (TomlTable& table : root.tables("location")) {
    LocationError location;
    read_name(table, machine, true, location.axis, location.component);
    location.state = read_state_of_error(table, machine, states);
    const Quantity quantity = error_quantity(location.component);
    if (!location_error_is_valid(machine.axes[location.axis], location.component)) {
      table.fail("name", "this component has no effect on the axis", "a location error that displaces the axis line");
    }
    for (const LocationError& other : errors.locations) {
      if (other.axis == location.axis && other.component == location.component && other.state == location.state) {
        table.fail("name", "is given twice");
      }
    }
    location.value = table.number("value", quantity);
    refuse_implausible(table, "value", quantity, location.value);
    location.standard_uncertainty = table.size_or("standard_uncertainty", quantity, 0);
    table.finish();
    errors.locations.push_back(location);
  }
  for (TomlTable& table : root.tables("reversal")) {
    Reversal reversal;
    const std::string name = table.text("axis");
    reversal.axis = machine.find_axis(name);
    if (reversal.axis == Machine::npos) {
      table.fail("axis", fmt::format("\"{}\" is not an axis of this machine", name), axis_names(machine));
    }
    for (const Reversal& other : errors.reversals) {
      if (other.axis == reversal.axis) table.fail("axis", "is given twice");
    }
    const Quantity quantity = axis_quantity(machine.axes[reversal.axis]);
    reversal.value = table.number("value", quantity);
    refuse_implausible(table, "value", quantity, reversal.value);
    reversal.standard_uncertainty = table.size_or("standard_uncertainty", quantity, 0);
    table.finish();
    errors.reversals.push_back(reversal);
  }
  if (auto tool = root.optional_table("tool_offset_error")) {
    const auto value = tool->numbers("value", Quantity::length, 3);
    errors.tool_offset_error = {value[0], value[1], value[2]};
    tool->finish();
  }
  if (auto table = root.optional_table("composition")) {
    errors.composition.order =
        static_cast<ErrorOrder>(table->word_or("order", 0, {"iso", "after-motion", "before-motion"}));
    errors.composition.first_order = table->boolean_or("first_order", false);
    table->finish();
  }
  if (auto table = root.optional_table("provenance")) {
    for (const std::string& key : table->keys()) contents.provenance.emplace_back(key, table->free_text(key));
  }
  if (auto table = root.optional_table("covered")) read_covered(*table, machine, contents);
  if (auto table = root.optional_table("ageing")) read_ageing(*table, contents);
  contents.distrusted = root.texts_or_none("distrusted");
  contents.misfit_accepted = root.boolean_or("misfit_accepted", false);
  contents.warnings = root.texts_or_none("warnings");
  if (root.has("covariance")) {
    const std::filesystem::path csv = folder / root.text("covariance");
    const MappedFile file(csv);
    contents.covariance = parse_covariance(file.text(), csv.string(), machine, errors);
  }
  root.text_or("covariance", "");
  if (contents.covariance.size() == 0) {
    contents.covariance = covariance_with_thermometers(machine, errors, expansions, first_expansion);
  }
  root.finish();
  return contents;
}

ErrorsFile read_errors(const std::filesystem::path& path, const Machine& machine, StatesOfErrors states) {
  return parse_errors(read_file_of_kind(path, ".errors.toml"), path, machine, states);
}

void refuse_states(const Machine& machine, const ErrorSet& errors, const std::string& job, UsableStates usable) {
  const auto refuse = [&](std::size_t state, const std::string& error) {
    if (state == kNoState || is_usable(machine, state, usable)) return;
    throw InputError({.field = error},
                     usable == UsableStates::none
                         ? "depends on a state, which " + job + " does not take into account"
                         : fmt::format("depends on {} ({}), which {} does not take into account",
                                       machine.states[state].name, state_kind_name(machine.states[state].kind), job),
                     usable == UsableStates::none ? "errors without states"
                                                  : "errors whose states follow from the commands (axis, gravity)");
  };
  for (const ErrorMotion& motion : errors.motions) {
    refuse(motion.state, error_motion_name(machine, motion.axis, motion.component, motion.state));
  }
  for (const LocationError& location : errors.locations) {
    refuse(location.state, location_error_name(machine, location.axis, location.component, location.state));
  }
}

std::string errors_text(const Machine& machine, const ErrorsFile& contents, const std::string& covariance_file) {
  const ErrorSet& errors = contents.errors;
  std::string text = "# Geometric errors, actual minus nominal: docs/formats.md, docs/conventions.md.\n";
  text += fmt::format("chain = {}\n", toml_string(machine.chain()));
  if (!covariance_file.empty()) text += fmt::format("covariance = {}\n", toml_string(covariance_file));
  text += toml_texts("distrusted", contents.distrusted);
  if (contents.misfit_accepted) text += "misfit_accepted = true\n";
  text += toml_texts("warnings", contents.warnings);
  if (!contents.provenance.empty()) text += "\n[provenance]\n";
  for (const auto& [key, value] : contents.provenance) {
    text += fmt::format("{} = {}\n", toml_string(key), toml_string(value));
  }
  text += covered_text(contents);
  if (!(errors.composition == Composition{})) {
    const char* const orders[] = {"iso", "after-motion", "before-motion"};
    text += fmt::format("\n[composition]\norder = \"{}\"\nfirst_order = {}\n",
                        orders[static_cast<std::size_t>(errors.composition.order)], errors.composition.first_order);
  }
  for (const ErrorMotion& motion : errors.motions) text += motion_text(machine, motion);
  for (const LocationError& location : errors.locations) {
    const Unit& unit = error_unit(location.component);
    text += fmt::format("\n[[location]]\nname = \"{}\"\n{}value_{} = {}\n",
                        location_error_name(machine, location.axis, location.component),
                        state_line(machine, location.state), unit.suffix, quantity_text(location.value, unit));
    if (location.standard_uncertainty > 0) {
      text += fmt::format("standard_uncertainty_{} = {}\n", unit.suffix,
                          quantity_text(location.standard_uncertainty, unit));
    }
  }
  for (const Reversal& reversal : errors.reversals) {
    const Axis& axis = machine.axes[reversal.axis];
    const Unit& unit = unit_named(axis_quantity(axis), axis.kind == AxisKind::rotary ? "urad" : "um");
    text += fmt::format("\n[[reversal]]\naxis = {}\nvalue_{} = {}\n", toml_string(axis.name), unit.suffix,
                        quantity_text(reversal.value, unit));
    if (reversal.standard_uncertainty > 0) {
      text += fmt::format("standard_uncertainty_{} = {}\n", unit.suffix,
                          quantity_text(reversal.standard_uncertainty, unit));
    }
  }
  const Eigen::Vector3d& tool = errors.tool_offset_error;
  if (tool != Eigen::Vector3d::Zero()) {
    text += fmt::format("\n[tool_offset_error]\nvalue_um = {}\n",
                        list_text({tool.x(), tool.y(), tool.z()}, unit_named(Quantity::length, "um")));
  }
  return text;
}

std::filesystem::path covariance_beside(const std::filesystem::path& path) {
  std::string name = path.stem().string();
  if (name.ends_with(".errors")) name.resize(name.size() - 7);
  return path.parent_path() / (name + ".covariance.csv");
}

void write_errors(const std::filesystem::path& path, const Machine& machine, const ErrorsFile& contents) {
  std::string beside;
  if (contents.covariance.size() > 0) {
    const std::filesystem::path covariance = covariance_beside(path);
    beside = covariance.filename().string();
    write_file_atomically(covariance, covariance_text(machine, contents));
  }
  write_file_atomically(path, errors_text(machine, contents, beside));
}

bool is_truth(const ErrorsFile& file) {
  return std::any_of(file.provenance.begin(), file.provenance.end(),
                     [](const auto& entry) { return entry.first == "method" && entry.second == kTruthOfSimulation; });
}

void require_trusted(const ErrorsFile& file, const std::string& path, bool accept_misfit) {
  if (file.distrusted.empty() || accept_misfit || file.misfit_accepted) return;
  throw InputError({.file = path, .field = "distrusted"},
                   "the identification marked these errors as not to be trusted: " + file.distrusted.front(),
                   "errors whose cause was found, or --accept-misfit to use them as they are");
}

Eigen::MatrixXd covariance_of(const ErrorsFile& file) {
  return file.covariance.size() > 0 ? file.covariance : stated_variances(file.errors);
}

}  // namespace abbe
