#include "abbe/formats/nc/nc_system_parameters.h"

#include <fmt/format.h>

#include <cmath>

#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

constexpr int kReferences[] = {5161, 5181};  // G28, G30
constexpr int kAxisOffsetIsOn = 5210, kAxisOffset = 5211, kSystem = 5220, kTool = 5400, kPosition = 5420;

int system_parameter(std::size_t system) { return 5221 + 20 * static_cast<int>(system); }
int rotation_of_system(std::size_t system) { return system_parameter(system) + 9; }

/// Whether a parameter is one of those of the axes, of which `first` is that of X.
bool is_of_axis(int number, int first, std::size_t& axis) {
  axis = static_cast<std::size_t>(number - first);
  return number >= first && number < first + static_cast<int>(kAxisWords);
}

/// Takes a parameter of the state. @param length  mm of the unit of lengths @returns whether it is one
bool take_parameter(int number, double value, double length, const InputError::Place& where, NcState& state) {
  std::size_t axis = 0;
  const auto scaled = [&] { return is_rotary_word(axis) ? value : value * length; };
  for (std::size_t i = 0; i < 2; ++i) {
    if (!is_of_axis(number, kReferences[i], axis)) continue;
    state.references[i].values[axis] = scaled();
    state.references[i].known |= axis_bit(axis);
    return true;
  }
  if (is_of_axis(number, kAxisOffset, axis)) {
    state.offsets.store_axis_offset(axis, scaled());
    return true;
  }
  for (std::size_t s = 0; s < NcOffsets::kSystems; ++s) {
    if (is_of_axis(number, system_parameter(s), axis)) {
      NcAxisValues values{};
      values[axis] = scaled();
      state.offsets.set_system(s, axis_bit(axis), values);
      return true;
    }
    if (number == rotation_of_system(s)) {
      if (value != 0) throw InputError(where, "a work offset that is rotated is not handled", "0");
      return true;
    }
  }
  if (number == kSystem) {
    if (!(value >= 1 && value <= 9)) throw InputError(where, "is not a work offset", "1 (G54) to 9 (G59.3)");
    state.offsets.use_system(static_cast<std::size_t>(std::lround(value)) - 1);
    return true;
  }
  return number == kAxisOffsetIsOn;
}

}  // namespace

void take_nc_parameters(const NcProgramOptions& options, const std::string& file, NcState& state,
                        NcParameters& parameters) {
  bool axis_offset_is_on = false;
  for (const auto& [number, value] : options.parameters) {
    const InputError::Place where{.file = file, .field = fmt::format("#{}", number)};
    if (number < 1 || number >= kNcParameters || !(std::abs(value) <= 1e9)) {
      throw InputError(where, "is not a parameter that can be set", "a number from 1 to 5601 and a value up to 1e9");
    }
    if (NcParameters::is_of_control(number)) continue;
    if (number == kAxisOffsetIsOn) axis_offset_is_on = value != 0;
    if (!take_parameter(number, value, options.parameters_in_inches ? kInch : 1, where, state)) {
      parameters.set(number, value);
    }
  }
  if (axis_offset_is_on) state.offsets.restore_axis_offset();
}

bool NcSystemParameters::offset(int number, double& value) const {
  std::size_t axis = 0;
  const auto stored = [&](double mm_or_degrees) {
    return is_rotary_word(axis) ? mm_or_degrees : mm_or_degrees / length_;
  };
  if (is_of_axis(number, kAxisOffset, axis)) {
    value = stored(state_.offsets.stored_axis_offset()[axis]);
    return true;
  }
  for (std::size_t s = 0; s < NcOffsets::kSystems; ++s) {
    if (!is_of_axis(number, system_parameter(s), axis)) continue;
    value = stored(state_.offsets.system_offset(s)[axis]);
    return true;
  }
  return false;
}

bool NcSystemParameters::numbered(int number, double& value) const {
  std::size_t axis = 0;
  for (std::size_t i = 0; i < 2; ++i) {
    if (!is_of_axis(number, kReferences[i], axis)) continue;
    const NcPlace& reference = state_.references[i];
    value = is_rotary_word(axis) ? reference.values[axis] : reference.values[axis] / length_;
    return (reference.known >> axis & 1) != 0;
  }
  if (offset(number, value)) return true;
  if (number == kSystem) {
    value = static_cast<double>(state_.offsets.system()) + 1;
    return true;
  }
  if (number == kTool && state_.tools.in_spindle()) {
    value = *state_.tools.in_spindle();
    return true;
  }
  if (is_of_axis(number, kPosition, axis)) {
    value = (state_.position.values()[axis] - state_.position.zero()[axis]) / state_.modes.unit(axis);
    return state_.position.is_known(axis);
  }
  return false;
}

bool NcSystemParameters::named(std::string_view name, double& value) const {
  const NcModes& modes = state_.modes;
  if (name.size() == 2) {
    const std::size_t axis = nc_axis(name[1]);
    return axis < kAxisWords && numbered(kPosition + static_cast<int>(axis), value);
  }
  const auto say = [&](double said) {
    value = said;
    return true;
  };
  if (name == "_line") return say(static_cast<double>(block_.cursor.line));
  // In inverse time LinuxCNC 2.9 says the speed of the last move instead, and its documentation F.
  if (name == "_feed" && modes.feed_mode != FeedMode::inverse_time) return say(modes.feed);
  if (name == "_metric") return say(modes.inches ? 0 : 1);
  if (name == "_imperial") return say(modes.inches ? 1 : 0);
  if (name == "_absolute") return say(modes.absolute ? 1 : 0);
  if (name == "_incremental") return say(modes.absolute ? 0 : 1);
  if (name == "_inverse_time") return say(modes.feed_mode == FeedMode::inverse_time ? 1 : 0);
  if (name == "_units_per_minute") return say(modes.feed_mode == FeedMode::per_minute ? 1 : 0);
  if (name == "_units_per_rev") return say(modes.feed_mode == FeedMode::per_revolution ? 1 : 0);
  if (name == "_motion_mode") return say(modes.motion);
  if (name == "_plane") return say(modes.plane == ArcPlane::XY ? 170 : modes.plane == ArcPlane::ZX ? 180 : 190);
  if (name == "_coord_system") {
    const auto system = static_cast<double>(state_.offsets.system());
    return say(system < 6 ? 540 + 10 * system : 585 + system);
  }
  if (name == "_current_tool" && state_.tools.in_spindle()) return say(*state_.tools.in_spindle());
  if (name == "_selected_tool" && state_.tools.selected()) return say(*state_.tools.selected());
  return false;
}

}  // namespace abbe
