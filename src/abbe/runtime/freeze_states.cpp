#include "abbe/runtime/freeze_states.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "abbe/errors/error_states.h"
#include "abbe/machine/coupling.h"
#include "abbe/runtime/frozen_layout.h"
#include "abbe/runtime/frozen_states.h"

namespace abbe {
namespace {

using Plan = FrozenStatePlan;
using Product = FrozenStatePlan::Product;

constexpr std::size_t kMostCornerStates = 8;
constexpr double kSecondOrder = 1.01;  // of what a unit of a factor does to the point

std::size_t index_in(std::vector<Product>& products, const Product& product) {
  const auto found = std::find(products.begin(), products.end(), product);
  if (found != products.end()) return static_cast<std::size_t>(found - products.begin());
  products.push_back(product);
  return products.size() - 1;
}

bool is_approach(const Machine& machine, std::size_t state) {
  const MachineState& one = machine.states[state];
  if (one.kind != StateKind::product) return one.kind == StateKind::approach;
  return is_approach(machine, one.first) || is_approach(machine, one.second);
}

void take_apart(const Machine& machine, std::size_t state, Plan& plan) {
  const MachineState& one = machine.states[state];
  Product given, computed;
  std::size_t computed_state = state;
  const auto take = [&](std::size_t part) {
    Product& product = is_input(machine.states[part].kind) ? given : computed;
    if (product.first == kNoState) {
      product.first = part;
    } else {
      product.second = part;
    }
  };
  if (one.kind == StateKind::product) {
    take(one.first);
    take(one.second);
    if (given.first != kNoState && computed.first != kNoState) computed_state = computed.first;
  } else {
    take(state);
  }
  if (given.first != kNoState) plan.parts[state].factor = index_in(plan.factors, given);
  if (computed.first == kNoState) return;
  plan.parts[state].pose = index_in(plan.poses, computed);
  plan.pose_state.resize(plan.poses.size(), computed_state);
}

StateRange range_of(const Machine& machine, std::size_t state, const FreezeOptions& options, std::string& problem) {
  const MachineState& one = machine.states[state];
  if (one.kind == StateKind::lag) return range_of(machine, one.first, options, problem);
  StateRange range;
  if (state < options.state_ranges.size()) range = options.state_ranges[state];
  const bool stated = range.from != 0 || range.to != 0;
  if (!stated && (one.unit == "degC" || one.unit == "K")) {
    range = {one.reference + kDefaultBelow, one.reference + kDefaultAbove};
  } else if (!stated) {
    problem =
        fmt::format("the range of the state {} is not given: --state-range {}=FROM:TO", one.name, state_column(one));
  }
  if (problem.empty() &&
      !(range.from < range.to && std::abs(range.from) <= frozen::kLongest && std::abs(range.to) <= frozen::kLongest)) {
    problem = fmt::format("the range of the state {} is empty or beyond 1e6", one.name);
  }
  return range;
}

double place_of(const Plan& plan, std::size_t state) {
  if (state == kNoState) return static_cast<double>(kNoFactor);
  return static_cast<double>(std::find(plan.states.begin(), plan.states.end(), state) - plan.states.begin());
}

void add_state(const Machine& machine, const Plan& plan, std::size_t index, std::vector<double>& out) {
  const MachineState& state = machine.states[index];
  const bool given = is_input(state.kind);
  const auto add = [&](double value) { out.push_back(value); };
  add(state.kind == StateKind::measured ? 0 : state.kind == StateKind::lag ? 1 : state.kind == StateKind::axis ? 2 : 3);
  add(state.kind == StateKind::measured ? 0 : given ? place_of(plan, state.first) : static_cast<double>(state.axis));
  const auto* const unit = std::find(std::begin(kStateUnits), std::end(kStateUnits), state.unit);
  add(given ? static_cast<double>(unit - std::begin(kStateUnits)) : 0);
  add(state.kind == StateKind::gravity ? 0 : state.reference);
  add(state.kind == StateKind::lag ? state.time_constant : 0);
  StateRange range{-frozen::kLongest, frozen::kLongest};
  if (given) range = plan.ranges[index];
  if (state.kind == StateKind::axis && !machine.axes[state.axis].endless) {
    // So far beyond the travel that no correction meets the end.
    const Axis& axis = machine.axes[state.axis];
    const double spare = axis.kind == AxisKind::linear ? 10 : 0.2;
    const PositionLimits travel = position_limits(machine, state.axis);
    range = {std::max(range.from, travel.from - spare), std::min(range.to, travel.to + spare)};
  }
  add(range.from);
  add(range.to);
  for (std::size_t k = 0; k < frozen::kStateName; ++k)
    add(k < state.name.size() ? static_cast<double>(state.name[k]) : 0);
  if (state.kind != StateKind::gravity) return;
  add(static_cast<double>(state.loads.size()));
  for (const GravityLoad& load : state.loads) {
    add(static_cast<double>(load.carried_by));
    for (int k = 0; k < 3; ++k) add(1e-3 * load.mass_kg * machine.gravity[k]);  // 1e-3: arms are in mm
    for (int k = 0; k < 3; ++k) add(load.point[k]);
  }
}

void add_locations(const Machine& machine, const ErrorSet& errors, const Plan& plan, std::vector<double>& out) {
  std::vector<double> rows;
  std::size_t count = 0;
  const auto number = [](std::size_t index) {
    return index == Plan::kNone ? static_cast<double>(kNoFactor) : static_cast<double>(index);
  };
  for (std::size_t axis = 0; axis < machine.axes.size(); ++axis) {
    const bool moves =
        std::any_of(errors.locations.begin(), errors.locations.end(),
                    [&](const LocationError& location) { return location.axis == axis && location.state != kNoState; });
    for (const LocationError& location : errors.locations) {
      if (!moves || location.axis != axis) continue;
      const Plan::Parts parts = plan.of(location.state);
      const LocationEffect effect = location_effect(machine.axes[axis], location.component);
      rows.insert(rows.end(), {static_cast<double>(axis), number(parts.factor), number(parts.pose)});
      for (int k = 0; k < 3; ++k) rows.push_back(location.value * effect.shift[k]);
      for (int k = 0; k < 3; ++k) rows.push_back(location.value * effect.tilt[k]);
      rows.push_back(location.value * effect.zero_position);
      ++count;
    }
  }
  out.push_back(static_cast<double>(count));
  out.insert(out.end(), rows.begin(), rows.end());
}

bool is_zero(const FrozenFunctions& functions) {
  return std::all_of(functions.rows.begin(), functions.rows.end(), [](const std::array<double, 6>& row) {
    return std::all_of(row.begin(), row.end(), [](double coefficient) { return coefficient == 0; });
  });
}

/// Coefficients of one group per unit of each given factor that it has.
/// @param place  of the group among those of its pose
/// @param group  in the file
/// @returns how many factors
std::size_t add_blocks(const Machine& machine, const ErrorSet& errors, const Plan& plan, std::size_t pose,
                       std::size_t place, std::size_t group, std::vector<double>& out, std::string& problem) {
  std::size_t blocks = 0;
  for (std::size_t j = 0; problem.empty() && j < plan.factors.size(); ++j) {
    const FrozenFunctions functions = frozen_functions(machine, motions_of(plan, errors, j, pose), problem)[place];
    if (is_zero(functions)) continue;
    ++blocks;
    out.push_back(static_cast<double>(group));
    out.push_back(static_cast<double>(j));
    for (const std::array<double, 6>& row : functions.rows) out.insert(out.end(), row.begin(), row.end());
  }
  return blocks;
}

}  // namespace

FrozenStatePlan plan_states(const Machine& machine, const ErrorSet& errors, const FreezeOptions& options,
                            std::string& problem) {
  Plan plan;
  plan.parts.resize(machine.states.size());
  plan.ranges.resize(machine.states.size());
  std::vector<bool> wanted(machine.states.size(), false);
  std::string name;
  const auto note = [&](std::size_t state, const std::string& error) {
    if (state == kNoState || !problem.empty()) return;
    if (is_approach(machine, state)) {
      problem = error + " depends on the side from which an axis came: a frozen compensation knows positions only";
      return;
    }
    take_apart(machine, state, plan);
    const MachineState& one = machine.states[state];
    std::vector<std::size_t> parts{state};
    if (one.kind == StateKind::product) parts = {one.first, one.second};
    for (const std::size_t part : parts) {
      wanted[part] = true;
      if (machine.states[part].kind == StateKind::lag) wanted[machine.states[part].first] = true;
    }
  };
  for (const ErrorMotion& motion : errors.motions)
    note(motion.state, error_motion_name(machine, motion.axis, motion.component, motion.state));
  for (const LocationError& location : errors.locations)
    note(location.state, location_error_name(machine, location.axis, location.component, location.state));
  std::size_t loads = 0;
  for (std::size_t k = 0; problem.empty() && k < machine.states.size(); ++k) {
    if (!wanted[k]) continue;
    plan.states.push_back(k);
    if (machine.states[k].name.size() > frozen::kStateName)
      problem = fmt::format("the name of the state {} is longer than 32 letters", machine.states[k].name);
    if (machine.states[k].kind == StateKind::gravity) loads += machine.states[k].loads.size();
    if (!is_input(machine.states[k].kind)) continue;
    plan.given.push_back(k);
    plan.ranges[k] = range_of(machine, k, options, problem);
  }
  if (problem.empty() && loads > frozen::kMostLoads) problem = "the gravity states have more than 64 loads";
  return plan;
}

ErrorSet motions_of(const FrozenStatePlan& plan, const ErrorSet& errors, std::size_t factor, std::size_t pose) {
  ErrorSet result;
  result.composition = errors.composition;
  for (ErrorMotion motion : errors.motions) {
    const Plan::Parts parts = plan.of(motion.state);
    if (parts.pose != pose) continue;
    if (parts.factor != factor) std::fill(motion.coefficients.begin(), motion.coefficients.end(), 0.0);
    motion.state = kNoState;
    result.motions.push_back(std::move(motion));
  }
  return result;
}

ErrorSet errors_per_unit(const FrozenStatePlan& plan, const ErrorSet& errors, std::size_t factor) {
  ErrorSet result;
  result.composition = errors.composition;
  const auto remaining = [&](const Plan::Parts& parts) {
    return parts.pose == Plan::kNone ? kNoState : plan.pose_state[parts.pose];
  };
  for (ErrorMotion motion : errors.motions) {
    const Plan::Parts parts = plan.of(motion.state);
    if (parts.factor != factor) continue;
    motion.state = remaining(parts);
    result.motions.push_back(std::move(motion));
  }
  for (LocationError location : errors.locations) {
    const Plan::Parts parts = plan.of(location.state);
    if (parts.factor != factor) continue;
    location.state = remaining(parts);
    result.locations.push_back(location);
  }
  return result;
}

ErrorSet constant_locations(const ErrorSet& errors) {
  ErrorSet result;
  result.composition = errors.composition;
  for (const LocationError& location : errors.locations) {
    if (location.state == kNoState) result.locations.push_back(location);
  }
  return result;
}

std::vector<std::vector<double>> corners(const Machine& machine, const FrozenStatePlan& plan) {
  if (plan.given.empty()) return {{}};
  std::vector<std::size_t> used;  // a channel that only has lags moves nothing itself
  for (const std::size_t state : plan.given) {
    if (std::any_of(plan.factors.begin(), plan.factors.end(),
                    [&](const Product& factor) { return factor.first == state || factor.second == state; })) {
      used.push_back(state);
    }
  }
  std::vector<std::vector<double>> all;
  if (used.size() > kMostCornerStates) return all;
  for (std::size_t corner = 0; corner < std::size_t{1} << used.size(); ++corner) {
    std::vector<double> given(machine.states.size(), std::numeric_limits<double>::quiet_NaN());
    for (std::size_t k = 0; k < used.size(); ++k) {
      const StateRange& range = plan.ranges[used[k]];
      given[used[k]] = (corner >> k & 1U) != 0 ? range.to : range.from;
    }
    all.push_back(std::move(given));
  }
  return all;
}

std::vector<double> group_values(const FrozenFunctions& functions) {
  const std::size_t per_function = functions.kind == 2 ? 4 : 1;
  std::vector<double> out{static_cast<double>(functions.axis),
                          static_cast<double>(functions.kind),
                          static_cast<double>(functions.rows.size() / per_function),
                          functions.everywhere ? 1.0 : 0.0,
                          functions.lowest,
                          functions.highest,
                          functions.first,
                          functions.second};
  if (functions.kind == 2) out.insert(out.end(), functions.nodes.begin(), functions.nodes.end());
  for (const std::array<double, 6>& row : functions.rows) out.insert(out.end(), row.begin(), row.end());
  return out;
}

std::vector<double> state_values(const Machine& machine, const ErrorSet& errors, const FrozenStatePlan& plan,
                                 const std::vector<FrozenFunctions>& groups, const std::vector<double>& largest,
                                 std::string& problem) {
  std::vector<double> out{static_cast<double>(plan.states.size())};
  for (const std::size_t state : plan.states) add_state(machine, plan, state, out);
  out.push_back(static_cast<double>(plan.factors.size()));
  for (std::size_t j = 0; j < plan.factors.size(); ++j) {
    const Product& factor = plan.factors[j];
    out.insert(out.end(), {place_of(plan, factor.first), place_of(plan, factor.second), kSecondOrder * largest[j]});
  }
  out.push_back(static_cast<double>(plan.poses.size()));
  for (const Product& pose : plan.poses)
    out.insert(out.end(), {place_of(plan, pose.first), place_of(plan, pose.second), 0.0});

  // Groups stand in the order of axes, as the file wants them; blocks in that of the groups.
  struct OfPose {
    std::size_t pose, place;
    FrozenFunctions functions;
  };
  std::vector<OfPose> posed;
  for (std::size_t p = 0; problem.empty() && p < plan.poses.size(); ++p) {
    const std::vector<FrozenFunctions> functions =
        frozen_functions(machine, motions_of(plan, errors, Plan::kNone, p), problem);
    for (std::size_t g = 0; g < functions.size(); ++g) posed.push_back({p, g, functions[g]});
  }
  std::stable_sort(posed.begin(), posed.end(),
                   [](const OfPose& a, const OfPose& b) { return a.functions.axis < b.functions.axis; });
  out.push_back(static_cast<double>(posed.size()));
  std::vector<double> blocks;
  std::size_t block_count = 0;
  for (std::size_t g = 0; g < groups.size(); ++g)
    block_count += add_blocks(machine, errors, plan, Plan::kNone, g, g, blocks, problem);
  for (std::size_t n = 0; n < posed.size(); ++n) {
    out.push_back(static_cast<double>(posed[n].pose));
    const std::vector<double> values = group_values(posed[n].functions);
    out.insert(out.end(), values.begin(), values.end());
    block_count += add_blocks(machine, errors, plan, posed[n].pose, posed[n].place, groups.size() + n, blocks, problem);
  }
  out.push_back(static_cast<double>(block_count));
  out.insert(out.end(), blocks.begin(), blocks.end());
  add_locations(machine, errors, plan, out);
  if (groups.size() + posed.size() > frozen::kMostGroups) problem = "more than 96 different sets of functions";
  if (block_count > frozen::kMostBlocks) problem = "more than 256 sets of coefficients with a state";
  if (errors.locations.size() > frozen::kMostLocations) problem = "more than 128 location errors";
  return out;
}

}  // namespace abbe
