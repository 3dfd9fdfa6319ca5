#include "abbe/runtime/abbe_runtime.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "abbe/runtime/frozen_correction.h"
#include "abbe/runtime/frozen_couplings.h"
#include "abbe/runtime/frozen_layout.h"

namespace abbe {
namespace {

bool usable(double value) { return std::abs(value) <= frozen::kLongest; }  // false for what is no number

bool usable(const double* values, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    if (!usable(values[i])) return false;
  }
  return true;
}

bool tool_of(const abbe_runtime& machine, const double* given, Triple& tool) {
  tool = machine.tool;
  if (given == nullptr) return true;
  if (!usable(given, 3)) return false;
  tool = {given[0], given[1], given[2]};
  return true;
}

/// Positions with cosines and sines; entries of solved axes are left for solve_point().
bool load(const abbe_runtime& machine, const double* values, bool but_solved, FrozenCommands& commands) {
  for (std::size_t i = 0; i < machine.axes; ++i) {
    if (but_solved && machine.axis[i].solved != FrozenAxis::kNotSolved) continue;
    const double position = position_at(machine, values, i);
    if (!usable(values[i]) || !usable(position)) return false;
    set_axis(machine.axis[i], i, position, commands);
  }
  return true;
}

void store(const abbe_runtime& machine, const FrozenCommands& commands, double* values) {
  for (std::size_t i = 0; i < machine.axes; ++i) values[i] = commands.at(i);
  to_commands(machine, values);
}

bool within(double value, double from, double to) {
  // A range as wide as a file can state has no end.
  return (value >= from || from <= -frozen::kLongest) && (value <= to || to >= frozen::kLongest);
}

/// Flags of a pose: where the errors are known is a matter of nominal joints, travel one of the joints.
int flags(const abbe_runtime& machine, const FrozenCommands& nominal, const FrozenCommands& joints, const Triple& tool,
          double enable) {
  int result = 0;
  double joint[kFrozenAxes];
  store(machine, joints, joint);
  for (std::size_t i = 0; i < machine.axes; ++i) {
    const FrozenAxis& axis = machine.axis[i];
    if (enable > 0 && !within(nominal.at(i), axis.map_min, axis.map_max)) result |= ABBE_OUTSIDE_MAP;
    if (!axis.endless && !within(joint[i], axis.travel_min, axis.travel_max)) result |= ABBE_OUTSIDE_TRAVEL;
  }
  // Of a tool of exactly one length the last digit may be another one.
  constexpr double kSpare = 1e-9;
  const double tool_length = -dot(tool, machine.tool_direction);
  if (enable > 0 &&
      !(tool_length >= machine.tool_length_min - kSpare && tool_length <= machine.tool_length_max + kSpare))
    result |= ABBE_OUTSIDE_TOOL;
  return result;
}

/// Commands to start from: the others moved by the last correction.
FrozenCommands started(const abbe_runtime& machine, const abbe_runtime_state* state, const FrozenCommands& from,
                       double sign) {
  FrozenCommands commands = from;
  if (state == nullptr) return commands;
  const auto start = [&](const FrozenChoice& choice, double largest) {
    for (std::size_t k = 0; k < choice.count; ++k) {
      const std::size_t i = choice.axis[k];
      const double bound = machine.axis[i].rotary ? machine.largest_turn : largest;
      const double correction = position_at(machine, state->correction, i);
      if (std::abs(correction) <= bound) move_axis(machine.axis[i], i, from, sign * correction, commands);
    }
  };
  start(machine.turning, machine.largest_turn);
  start(machine.reaching, machine.largest_shift);
  return commands;
}

void keep(const abbe_runtime& machine, const FrozenCommands& nominal, const FrozenCommands& joints, int iterations,
          abbe_runtime_state* state) {
  if (state == nullptr) return;
  // The commands that both have come from are the same but for axes that were solved from the point.
  for (std::size_t i = 0; i < machine.axes; ++i)
    state->correction[i] = (joints.q[i] - nominal.q[i]) + (joints.by[i] - nominal.by[i]);
  to_commands(machine, state->correction);
  state->iterations = iterations;
}

/// Nominal joints to actual ones.
int compensate(const abbe_runtime& machine, abbe_runtime_state* state, const FrozenCommands& nominal,
               const NominalView& view, const Triple& goal, const Triple& tool, double enable, double* joints) {
  if (enable > 0 && machine.needs_states) return ABBE_STATES_NOT_GIVEN;
  FrozenCommands actual = enable > 0 ? started(machine, state, nominal, 1) : nominal;
  FrozenResult found;
  if (enable > 0) found = solve_actual(machine, nominal, view, goal, tool, enable, actual);
  if (found.result >= 0) keep(machine, nominal, actual, found.iterations, state);
  if (found.result < 0) return found.result;
  store(machine, actual, joints);
  return found.result | flags(machine, nominal, actual, tool, enable);
}

/// Origins of axes as they are once the solved axes stand where they should.
void place_origins(const abbe_runtime& machine, const FrozenCommands& commands, NominalView& view) {
  Triple moved{};
  for (std::size_t i = 0; i < machine.axes; ++i) {
    if (machine.axis[i].solved != FrozenAxis::kNotSolved) moved = moved + commands.at(i) * view.column[i];
    view.origin[i] = view.origin[i] + moved;
  }
}

/// Nominal joints of a pose; solved axes included.
int nominal_joints(const abbe_runtime& machine, const double* point, const double* words, const Triple& tool,
                   FrozenCommands& nominal, NominalView& view, Triple& goal) {
  if (machine.solved.count < 3) return ABBE_NOT_POSSIBLE;
  if (!usable(point, 3) || !load(machine, words, true, nominal)) return ABBE_NOT_FINITE;
  view = nominal_view(machine, nominal, tool, true);
  goal = Triple{point[0], point[1], point[2]} + machine.world_zero;
  return solve_point(machine, view, goal, nominal) ? ABBE_OK : ABBE_SINGULAR;
}

/// Actual joints to nominal ones and the point in the workpiece frame.
int uncompensate(const abbe_runtime& machine, abbe_runtime_state* state, const FrozenCommands& actual,
                 const Triple& tool, double enable, FrozenCommands& nominal, Triple& point) {
  if (!(enable > 0)) {
    nominal = actual;
    point = nominal_view(machine, actual, tool, false).point;
    keep(machine, nominal, actual, 0, state);
    return flags(machine, nominal, actual, tool, enable);
  }
  if (machine.needs_states) return ABBE_STATES_NOT_GIVEN;
  nominal = started(machine, state, actual, -1);
  const FrozenResult found = solve_nominal(machine, actual, tool, enable, nominal, point);
  if (found.result < 0) return found.result;
  if (machine.reaching_linear && !solve_point(machine, nominal_view(machine, nominal, tool, true), point, nominal))
    return ABBE_SINGULAR;
  keep(machine, nominal, actual, found.iterations, state);
  return found.result | flags(machine, nominal, actual, tool, enable);
}

}  // namespace
// The functions of the C interface are those of the global namespace wherever they are defined.
extern "C" {

void abbe_runtime_start(abbe_runtime_state* state) ABBE_NOEXCEPT {
  if (state != nullptr) *state = {};
}

void abbe_runtime_tool_of_offset(const abbe_runtime* runtime, const double* offset, double* tool) ABBE_NOEXCEPT {
  if (runtime == nullptr || offset == nullptr || tool == nullptr) return;
  // World axes are those of the workpiece, turned against the machine's.
  const Triple t = times_inverse(runtime->workpiece_from_bed, {-offset[0], -offset[1], -offset[2]});
  tool[0] = t.x;
  tool[1] = t.y;
  tool[2] = t.z;
}

int abbe_runtime_nominal_inverse(const abbe_runtime* runtime, const double* point, const double* words,
                                 const double* tool, double* joints) ABBE_NOEXCEPT {
  return abbe_runtime_inverse(runtime, nullptr, point, words, tool, 0, joints);
}

int abbe_runtime_nominal_forward(const abbe_runtime* runtime, const double* joints, const double* tool, double* point,
                                 double* words) ABBE_NOEXCEPT {
  return abbe_runtime_forward(runtime, nullptr, joints, tool, 0, point, words);
}

int abbe_runtime_inverse(const abbe_runtime* runtime, abbe_runtime_state* state, const double* point,
                         const double* words, const double* tool, double enable, double* joints) ABBE_NOEXCEPT {
  if (runtime == nullptr || point == nullptr || words == nullptr || joints == nullptr) return ABBE_NULL;
  Triple of_tool{}, goal{};
  if (!tool_of(*runtime, tool, of_tool) || !usable(enable)) return ABBE_NOT_FINITE;
  FrozenCommands nominal;
  NominalView view;
  const int result = nominal_joints(*runtime, point, words, of_tool, nominal, view, goal);
  if (result < 0) return result;
  place_origins(*runtime, nominal, view);
  return compensate(*runtime, state, nominal, view, goal, of_tool, std::clamp(enable, 0.0, 1.0), joints);
}

int abbe_runtime_forward(const abbe_runtime* runtime, abbe_runtime_state* state, const double* joints,
                         const double* tool, double enable, double* point, double* words) ABBE_NOEXCEPT {
  if (runtime == nullptr || joints == nullptr || point == nullptr || words == nullptr) return ABBE_NULL;
  if (runtime->solved.count < 3) return ABBE_NOT_POSSIBLE;
  Triple of_tool{}, at{};
  FrozenCommands actual, nominal;
  if (!tool_of(*runtime, tool, of_tool) || !usable(enable) || !load(*runtime, joints, false, actual))
    return ABBE_NOT_FINITE;
  const int result = uncompensate(*runtime, state, actual, of_tool, std::clamp(enable, 0.0, 1.0), nominal, at);
  if (result < 0) return result;
  at = at - runtime->world_zero;
  point[0] = at.x;
  point[1] = at.y;
  point[2] = at.z;
  store(*runtime, nominal, words);
  return result;
}

int abbe_runtime_correct(const abbe_runtime* runtime, abbe_runtime_state* state, const double* nominal,
                         const double* tool, double enable, double* joints) ABBE_NOEXCEPT {
  if (runtime == nullptr || nominal == nullptr || joints == nullptr) return ABBE_NULL;
  Triple of_tool{};
  FrozenCommands commands;
  if (!tool_of(*runtime, tool, of_tool) || !usable(enable) || !load(*runtime, nominal, false, commands))
    return ABBE_NOT_FINITE;
  const NominalView view = nominal_view(*runtime, commands, of_tool, false);
  return compensate(*runtime, state, commands, view, view.point, of_tool, std::clamp(enable, 0.0, 1.0), joints);
}

int abbe_runtime_uncorrect(const abbe_runtime* runtime, abbe_runtime_state* state, const double* joints,
                           const double* tool, double enable, double* nominal) ABBE_NOEXCEPT {
  if (runtime == nullptr || joints == nullptr || nominal == nullptr) return ABBE_NULL;
  Triple of_tool{}, at{};
  FrozenCommands actual, found;
  if (!tool_of(*runtime, tool, of_tool) || !usable(enable) || !load(*runtime, joints, false, actual))
    return ABBE_NOT_FINITE;
  const int result = uncompensate(*runtime, state, actual, of_tool, std::clamp(enable, 0.0, 1.0), found, at);
  if (result >= 0) store(*runtime, found, nominal);
  return result;
}

int abbe_runtime_uncertainty(const abbe_runtime* runtime, const double* joints, const double* tool,
                             double* uncertainty_mm) ABBE_NOEXCEPT {
  if (runtime == nullptr || joints == nullptr || uncertainty_mm == nullptr) return ABBE_NULL;
  if (runtime->uncertainty.dimensions == 0) return ABBE_NOT_STATED;
  Triple of_tool{};
  if (!tool_of(*runtime, tool, of_tool)) return ABBE_NOT_FINITE;
  FrozenCommands commands;
  if (!load(*runtime, joints, false, commands)) return ABBE_NOT_FINITE;
  *uncertainty_mm = runtime->uncertainty.at(joints, -dot(of_tool, runtime->tool_direction));
  // The lattice has not all axes and tools: what it leaves out has ends as well.
  return flags(*runtime, commands, commands, of_tool, 1);
}

const char* abbe_runtime_text(int result) ABBE_NOEXCEPT {
  switch (result) {
    case ABBE_NOT_FINITE:
      return "an input is not a number or too large";
    case ABBE_NOT_CONVERGED:
      return "not converged";
    case ABBE_NOT_POSSIBLE:
      return "the machine does not have three linear axes to reach a point";
    case ABBE_SINGULAR:
      return "the linear axes lie in one plane";
    case ABBE_NULL:
      return "a pointer is null or an axis does not exist";
    case ABBE_NOT_STATED:
      return "the errors that were frozen had no uncertainties";
    case ABBE_STATES_NOT_GIVEN:
      return "the errors depend on states, which are not given";
    case ABBE_STALE:
      return "the stored states are too old or from the future";
    case ABBE_FILE_SHORT:
      return "the file is truncated";
    case ABBE_FILE_LONG:
      return "bytes follow the end of the compensation";
    case ABBE_FILE_FOREIGN:
      return "the file is not a frozen compensation";
    case ABBE_FILE_ORDER:
      return "the file was written by a computer of another byte order";
    case ABBE_FILE_VERSION:
      return "the file has another version of the format: freeze the compensation again";
    case ABBE_FILE_CHECKSUM:
      return "the file is damaged: its checksum is wrong";
    case ABBE_FILE_CONTENT:
      return "the content of the file is not usable";
    case ABBE_FILE_NO_MEMORY:
      return "no memory";
    default:
      break;
  }
  if (result < 0) return "unknown";
  if ((result & ABBE_OUTSIDE_MAP) != 0) return "outside the map";
  if ((result & ABBE_OUTSIDE_TRAVEL) != 0) return "outside travel";
  if ((result & ABBE_OUTSIDE_TOOL) != 0) return "tool shorter or longer than checked";
  switch (result & ABBE_RESULT_MASK) {
    case ABBE_ORIENTATION_LEFT:
      return "orientation left";
    case ABBE_TURN_LIMITED:
      return "turn limited";
    case ABBE_POSITION_LEFT:
      return "position left";
    default:
      return "ok";
  }
}

}  // extern "C"

}  // namespace abbe
