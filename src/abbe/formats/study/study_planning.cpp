#include "abbe/formats/study/study_planning.h"

#include <fmt/format.h>

#include "abbe/errors/poses.h"
#include "abbe/formats/study/study_parts.h"
#include "abbe/machine/axis_unit.h"
#include "abbe/machine/state.h"

namespace abbe {
namespace {

constexpr int kMostReadings = 100'000;
constexpr int kMostCandidates = 200'000;
constexpr int kMostLevels = 20;
constexpr int kMostConditions = 100;

std::vector<double> read_speeds(TomlTable& parent, const Machine& machine) {
  std::vector<double> speeds;
  auto table = parent.optional_table("speed");
  for (const Axis& axis : machine.axes) {
    const bool rotary = axis.kind == AxisKind::rotary;
    const double unit = position_unit(axis) / 60;  // of mm or degrees per minute
    const std::string key = axis.name + "_" + position_suffix(axis) + "_per_min";
    const double otherwise = rotary ? 3600 : 6000;
    const double speed = table ? table->number_or(key, Quantity::dimensionless, otherwise) : otherwise;
    if (speed <= 0) table->fail(key, "is not above zero", "a speed");
    speeds.push_back(speed * unit);
  }
  if (table) table->finish();
  return speeds;
}

ForbiddenBox read_box(TomlTable& table) {
  ForbiddenBox box;
  box.frame = table.word_or("frame", 0, {"workpiece", "machine"}) == 0 ? Body::workpiece : Body::bed;
  const std::vector<double> from = table.numbers("from", Quantity::length, 3);
  const std::vector<double> to = table.numbers("to", Quantity::length, 3);
  for (int i = 0; i < 3; ++i) {
    const std::size_t k = static_cast<std::size_t>(i);
    box.from[i] = from[k];
    box.to[i] = to[k];
    if (from[k] >= to[k]) table.fail_quantity("to", Quantity::length, "is not beyond from", "the opposite corner");
  }
  table.finish();
  return box;
}

PlannedSetup read_planned_setup(TomlTable& parent, const std::string& name) {
  TomlTable table = parent.table(name);
  PlannedSetup setup{name, table.size_or("set_up", Quantity::time, 0), {}, {}};
  if (table.has("settle", Quantity::time)) setup.settle = table.size_or("settle", Quantity::time, 0);
  if (table.has("reading", Quantity::time)) setup.reading = table.size_or("reading", Quantity::time, 0);
  table.finish();
  return setup;
}

std::vector<double> read_values(TomlTable& table) {
  const auto listed = table.optional_numbers("values", Quantity::dimensionless);
  std::vector<double> values;
  if (listed) {
    values = *listed;
  } else {
    const double from = table.number("from", Quantity::dimensionless);
    const double to = table.number("to", Quantity::dimensionless);
    if (!(from < to)) table.fail("to", "is not above from", "the higher end of the range, or values = [...]");
    values = evenly_spaced(from, to, static_cast<std::size_t>(table.integer_or("levels", 3, 2, kMostLevels)));
  }
  if (values.empty()) table.fail("values", "is empty", "the values at which readings can be taken");
  for (std::size_t k = 1; k < values.size(); ++k) {
    if (!(values[k - 1] < values[k])) table.fail("values", "do not increase", "each value above the one before");
  }
  return values;
}

/// Table [plan.state]: keys are names of states. What is in them is in the unit of the state.
std::vector<PlannedState> read_states(TomlTable& parent, const Machine& machine) {
  std::vector<PlannedState> states;
  for (const std::string& name : parent.keys()) {
    PlannedState planned;
    planned.state = find_state(machine, name);
    if (planned.state == kNoState || !is_input(machine.states[planned.state].kind)) {
      parent.fail(name,
                  planned.state == kNoState
                      ? "is not a state of this machine"
                      : fmt::format("is computed ({})", state_kind_name(machine.states[planned.state].kind)),
                  "the name of a state of kind \"measured\" or \"lag\"");
    }
    TomlTable table = parent.table(name);
    planned.values = read_values(table);
    const std::vector<double> ends = {planned.values.front(), planned.values.back()};
    const std::vector<double> used = table.optional_numbers("used", Quantity::dimensionless, 2).value_or(ends);
    if (used[0] > used[1]) table.fail("used", "does not increase", "the range [from, to] in which errors are used");
    planned.used_from = used[0];
    planned.used_to = used[1];
    planned.change = table.size_or("change", Quantity::time, 0);
    table.finish();
    states.push_back(std::move(planned));
  }
  parent.finish();
  double conditions = 1;
  for (const PlannedState& state : states) conditions *= static_cast<double>(state.values.size());
  if (conditions > kMostConditions) {
    parent.fail("", fmt::format("there are {:g} combinations of values", conditions),
                fmt::format("at most {} of all states together", kMostConditions));
  }
  return states;
}

PlannedCourse read_course(TomlTable& table, const Machine& machine, const std::filesystem::path& folder) {
  PlannedCourse course;
  course.channels = read_channel_plan(table, folder, machine);
  if (course.channels.files.empty()) {
    table.fail("channels", "is missing", "a file with the expected course of the states, channels = \"day.csv\"");
  }
  course.slot = table.size_or("slot", Quantity::time, 3600);
  if (!(course.slot > 0))
    table.fail_quantity("slot", Quantity::time, "is not above zero", "a time such as slot_min = 60");
  course.visit = table.size_or("visit", Quantity::time, 0);
  table.finish();
  return course;
}

void read_conditions(TomlTable& table, const Machine& machine, const std::filesystem::path& folder,
                     PlanningStudy& plan) {
  if (auto states = table.optional_table("state")) plan.states = read_states(*states, machine);
  if (auto course = table.optional_table("course")) {
    if (!plan.states.empty()) {
      table.fail("course", "is given beside [plan.state]", "a course of the states, or values at which they stand");
    }
    plan.course = read_course(*course, machine, folder);
  }
  plan.conditions = static_cast<std::size_t>(table.integer_or("conditions", 0, 0, kMostConditions));
}

}  // namespace

const PlannedSetup* PlanningStudy::find(const std::string& setup) const {
  for (const PlannedSetup& one : setups) {
    if (one.name == setup) return &one;
  }
  return nullptr;
}

double PlanningStudy::settle_of(const std::string& setup) const {
  const PlannedSetup* const own = find(setup);
  return own != nullptr ? own->settle.value_or(settle) : settle;
}

double PlanningStudy::reading_of(const std::string& setup) const {
  const PlannedSetup* const own = find(setup);
  return own != nullptr ? own->reading.value_or(reading) : reading;
}

double PlanningStudy::set_up_of(const std::string& setup) const {
  const PlannedSetup* const own = find(setup);
  return own != nullptr ? own->set_up : 0;
}

PlanningStudy read_planning(TomlTable& table, const Machine& machine, const std::filesystem::path& folder) {
  PlanningStudy plan;
  plan.readings = static_cast<int>(table.integer_or("readings", 0, 0, kMostReadings));
  plan.time = table.size_or("time", Quantity::time, 0);
  if (plan.readings == 0 && plan.time == 0) {
    table.fail("", "neither a number nor a time is given", "readings = 200, or time_s = 3600");
  }
  plan.goal = static_cast<PlanningGoal>(table.word_or("goal", 0, {"volumetric", "determinant", "parameters"}));
  plan.parameters = table.texts_or_none("parameters");
  if (plan.parameters.empty() == (plan.goal == PlanningGoal::parameters)) {
    table.fail("parameters", plan.parameters.empty() ? "are missing" : "belong to goal = \"parameters\"",
               "names or patterns such as \"EXX[*]\", with that goal only");
  }
  plan.target = table.size_or("target", Quantity::length, 0);
  plan.grid = table.word_or("candidates", 0, {"random", "grid"}) == 1;
  if (plan.grid && table.has("poses")) table.fail("poses", "belongs to random candidates", "counts in [plan.axis.X]");
  plan.candidates = static_cast<int>(table.integer_or("poses", 3000, 10, kMostCandidates));
  if (table.has("axis")) {
    plan.axes = read_axis_ranges(table, machine, plan.grid);
  } else {
    plan.axes = full_ranges(machine, 5);
  }
  double grid = 1;
  bool moves = false;
  for (const AxisRange& range : plan.axes) {
    moves = moves || !range.is_fixed();
    if (plan.grid) grid *= range.is_fixed() ? 1 : static_cast<double>(range.count);
  }
  if (!moves) table.fail("axis", "no axis moves", "the range of an axis");
  if (grid > kMostCandidates) table.fail("axis", fmt::format("the grid has {:.3g} poses", grid), "at most 200000");
  plan.speed = read_speeds(table, machine);
  plan.settle = table.size_or("settle", Quantity::time, 2);
  plan.reading = table.size_or("reading", Quantity::time, 1);
  for (TomlTable& box : table.tables("forbidden")) plan.forbidden.push_back(read_box(box));
  if (auto setups = table.optional_table("setup")) {
    for (const std::string& name : setups->keys()) plan.setups.push_back(read_planned_setup(*setups, name));
    setups->finish();
  }
  read_conditions(table, machine, folder, plan);
  table.finish();
  return plan;
}

}  // namespace abbe
