#include <algorithm>
#include <cmath>

#include "abbe/runtime/frozen_states.h"
#include "abbe/runtime/frozen_values.h"

namespace abbe {
namespace {

constexpr std::size_t kUnits = 8;  // of kStateUnits

bool is_given(const FrozenState& state) {
  return state.kind == FrozenState::Kind::measured || state.kind == FrozenState::Kind::lag;
}

void read_loads(Values& values, const abbe_runtime& m, FrozenStates& states, FrozenState& state) {
  state.first_load = states.loads;
  state.loads = values.whole(frozen::kMostLoads - states.loads, "loads of a state");
  for (std::size_t k = 0; values.ok() && k < state.loads; ++k) {
    FrozenLoad& load = states.load[states.loads++];
    load.axis = values.whole(m.axes - 1, "loads of a state");
    load.weight = values.triple("loads of a state");
    load.point = values.triple("loads of a state");
    if (values.ok()) values.require(m.axis[load.axis].tool_side == m.axis[state.of].tool_side, "loads of a state");
  }
}

void read_state(Values& values, const abbe_runtime& m, FrozenStates& states, FrozenState& state) {
  state.kind = static_cast<FrozenState::Kind>(values.whole(3, "kind of a state"));
  state.of = values.whole(is_given(state) ? kFrozenStates - 1 : m.axes - 1, "axis or channel of a state");
  state.unit = values.whole(kUnits - 1, "unit of a state");
  state.reference = values.length("reference of a state");
  state.time_constant = values.number(0, 1e9, "time constant of a state");
  state.from = values.length("range of a state");
  state.to = values.length("range of a state");
  values.require(state.to > state.from, "range of a state");
  for (std::size_t k = 0; k < frozen::kStateName; ++k)
    state.name[k] = static_cast<char>(values.whole('z', "name of a state"));
  values.require(state.name[0] != 0, "name of a state");
  if (values.ok() && state.kind == FrozenState::Kind::gravity) read_loads(values, m, states, state);
  if (state.kind == FrozenState::Kind::measured) {
    state.place = states.channels;
    states.channel[states.channels++] = static_cast<std::size_t>(&state - states.state.data());
  }
  if (state.kind == FrozenState::Kind::lag) {
    values.require(state.time_constant >= 1e-6, "time constant of a state");
    state.place = states.lags;
    states.lag[states.lags++] = static_cast<std::size_t>(&state - states.state.data());
  }
}

/// Products of one or two states.
void read_factors(Values& values, const FrozenStates& states, bool given, std::size_t& count,
                  std::array<FrozenFactor, kFrozenStates>& factors) {
  constexpr std::string_view kField = "factors of states";
  count = values.whole(kFrozenStates, kField);
  for (std::size_t k = 0; values.ok() && k < count; ++k) {
    FrozenFactor& factor = factors[k];
    factor.first = values.whole(kFrozenStates, kField);
    factor.second = values.whole(kFrozenStates, kField);
    factor.largest = values.number(0, frozen::kLongest, kField);
    const auto fits = [&](std::size_t state) { return state < states.count && is_given(states.state[state]) == given; };
    values.require(fits(factor.first) && (factor.second == kNoFactor || fits(factor.second)), kField);
  }
}

void read_pose_groups(Values& values, const abbe_runtime& m, FrozenStates& states, FrozenGroup* group,
                      std::size_t groups, double*& room) {
  constexpr std::string_view kField = "groups with a state";
  const std::size_t more = values.whole(frozen::kMostGroups - groups, kField);
  states.groups = groups + more;
  std::size_t before = 0;
  for (std::size_t g = groups; values.ok() && g < states.groups; ++g) {
    const std::size_t pose = values.whole(kFrozenStates, kField);
    values.require(pose < states.poses, kField);
    states.pose_of[g] = static_cast<std::uint8_t>(pose);
    std::size_t axis = 0;
    read_group(values, m, *new (group + g) FrozenGroup, axis, room);
    values.require(axis >= before, kField);
    before = axis;
    if (states.of_axis[axis]++ == 0) states.first_group[axis] = g;
  }
}

void read_blocks(Values& values, FrozenStates& states, const FrozenGroup* group, double*& room) {
  constexpr std::string_view kField = "coefficients of a state";
  states.blocks = values.whole(frozen::kMostBlocks, kField);
  for (std::size_t b = 0; values.ok() && b < states.blocks; ++b) {
    FrozenBlock& block = states.block[b];
    block.group = values.whole(frozen::kMostGroups, kField);
    block.factor = values.whole(kFrozenStates, kField);
    values.require(block.group < states.groups && block.factor < states.factors, kField);
    values.require(b == 0 || states.block[b - 1].group <= block.group, kField);
    if (!values.ok()) return;
    const std::size_t count = 6 * group_rows(group[block.group]);
    values.require(values.left() >= count, kField);
    if (!values.ok()) return;
    block.coefficients = room;
    for (std::size_t k = 0; k < count; ++k)
      *room++ = values.number(-frozen::kLargestError, frozen::kLargestError, kField);
  }
}

void read_locations(Values& values, const abbe_runtime& m, FrozenStates& states) {
  constexpr std::string_view kField = "location errors with a state";
  states.locations = values.whole(frozen::kMostLocations, kField);
  for (std::size_t k = 0; values.ok() && k < states.locations; ++k) {
    FrozenLocation& location = states.location[k];
    location.axis = values.whole(m.axes - 1, kField);
    location.factor = values.whole(kFrozenStates, kField);
    location.pose = values.whole(kFrozenStates, kField);
    values.require(location.factor == kNoFactor || location.factor < states.factors, kField);
    values.require(location.pose == kNoFactor || location.pose < states.poses, kField);
    values.require(k == 0 || states.location[k - 1].axis <= location.axis, kField);
    const auto small = [&] { return values.number(-frozen::kLargestError, frozen::kLargestError, kField); };
    for (Triple* const one : {&location.line.shift, &location.line.tilt}) {
      one->x = small();
      one->y = small();
      one->z = small();
    }
    location.line.zero = small();
    if (location.pose != kNoFactor) states.located[location.axis] = true;
    if (location.pose == kNoFactor && location.factor != kNoFactor) states.placed[location.axis] = true;
  }
}

}  // namespace

void read_states(Values& values, abbe_runtime& m, FrozenStates& states, FrozenGroup* group, std::size_t groups,
                 double*& room) {
  states.count = values.whole(kFrozenStates, "number of states");
  for (std::size_t k = 0; values.ok() && k < states.count; ++k) read_state(values, m, states, states.state[k]);
  for (std::size_t k = 0; values.ok() && k < states.lags; ++k) {
    const std::size_t of = states.state[states.lag[k]].of;
    values.require(of < states.count && states.state[of].kind == FrozenState::Kind::measured,
                   "axis or channel of a state");
  }
  read_factors(values, states, true, states.factors, states.factor);
  read_factors(values, states, false, states.poses, states.pose);
  if (values.ok()) read_pose_groups(values, m, states, group, groups, room);
  if (values.ok()) read_blocks(values, states, group, room);
  if (values.ok()) read_locations(values, m, states);
  if (!values.ok()) return;
  states.posed.states = &states;
  states.posed.group = group;
  m.states = &states;
  m.needs_states = states.factors > 0;
  if (states.poses == 0) return;
  m.posed = &states.posed;
  // With given states at their references, which is all there is where no error depends on a given one.
  for (std::size_t k = 0; k < states.locations; ++k) {
    const FrozenLocation& location = states.location[k];
    if (location.factor != kNoFactor) continue;
    states.posed.location[k] = location.line;
    if (location.pose == kNoFactor) states.posed.line[location.axis].add(1, location.line);
  }
}

}  // namespace abbe
