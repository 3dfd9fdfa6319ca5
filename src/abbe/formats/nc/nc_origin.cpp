#include "abbe/formats/nc/nc_origin.h"

#include <fmt/format.h>

#include <cmath>
#include <string>

namespace abbe {

NcAxisValues NcOriginCodes::axis_words(const NcCodedBlock& block) const {
  NcAxisValues values{};
  for_axes(block.axes, [&](std::size_t k) { values[k] = state_.modes.length(block, k); });
  return values;
}

bool NcOriginCodes::run(const NcCodedBlock& block, bool moves) {
  if (block.code(NcGroup::non_modal) == 100) return set_stored(block);
  set_axis_offset(block, moves);
  return true;
}

bool NcOriginCodes::set_stored(const NcCodedBlock& block) {
  const NcWord& word = block.word(NcGroup::non_modal);
  const double kind = block.has('l') ? block.value('l') : -1;
  if (kind != 1 && kind != 2 && kind != 20) {
    block.fail(block.has('l') ? block.word('l') : word, "is not a G10 that is handled", "L1, L2 or L20");
  }
  if (!block.has('p')) block.fail(word, "P is missing", kind == 1 ? "the tool" : "0 (current) to 9 (G59.3)");
  const double written = block.value('p');
  if (std::abs(written - std::round(written)) > 1e-4) block.fail('p', "is not a whole number");
  const auto number = static_cast<int>(std::lround(written));
  if (kind == 1) {
    state_.tools.set_offset(block, number, state_.modes);
    pass_.block(block, state_.modes, false);
    return false;
  }
  if (number < 0 || number > 9) block.fail('p', "is not a work offset", "0 (current) to 9 (G59.3)");
  if (block.has('r') && block.value('r') != 0) block.fail('r', "a rotated work offset is not handled");
  const std::size_t system = number == 0 ? state_.offsets.system() : static_cast<std::size_t>(number - 1);
  if (kind == 2) {
    state_.offsets.set_system(system, block.axes, axis_words(block));
    pass_.block(block, state_.modes, false);
  } else {
    set_system_by_position(block, system);
  }
  return system == state_.offsets.system();
}

void NcOriginCodes::set_system_by_position(const NcCodedBlock& block, std::size_t system) {
  NcOffsets& offsets = state_.offsets;
  const NcPosition& position = state_.position;
  position.require(block.axes, block, "G10 L20 takes it");
  offsets.set_system(system, block.axes, offsets.system_at(block.axes, position.values(), axis_words(block)));
  // The control stands where the correction has put it: it is told the offset itself.
  std::string text = fmt::format("G10 L2 P{}", system + 1);
  for_axes(block.axes, [&](std::size_t k) {
    text += fmt::format(" {}{:.10f}", kWrittenAxisLetters[k], offsets.system_offset(system)[k] / state_.modes.unit(k));
  });
  pass_.block_with(block, state_.modes, text, "lp");
}

void NcOriginCodes::set_axis_offset(const NcCodedBlock& block, bool moves) {
  NcOffsets& offsets = state_.offsets;
  const NcPosition& position = state_.position;
  const NcCode code = block.code(NcGroup::non_modal);
  if ((code == 920 || code == 520) && block.axes == 0) {
    block.fail(block.word(NcGroup::non_modal), "axis words are missing");
  }
  switch (code) {
    case 520:
      offsets.set_axis_offset(block.axes, axis_words(block));
      break;
    case 920: {
      position.require(block.axes, block, "G92 takes it");
      NcAxisValues shown{};
      for_axes(block.axes, [&](std::size_t k) { shown[k] = position.values()[k] - position.zero()[k]; });
      offsets.shift_axis_offset(block.axes, shown, axis_words(block));
      pass_axis_offset(block);
      return;
    }
    case 921:
      offsets.clear_axis_offset();
      break;
    case 922:
      offsets.suspend_axis_offset();
      break;
    default:
      offsets.restore_axis_offset();
      break;
  }
  pass_.block(block, state_.modes, moves);
}

void NcOriginCodes::pass_axis_offset(const NcCodedBlock& block) {
  // The control stands where the correction has put it, not where the program has sent it: the words say what leads to
  // the same offset from there.
  writer_.flush();
  std::string text = "G92";
  for_axes(block.axes, [&](std::size_t k) {
    double stands = 0;
    if (!writer_.position(k, stands)) stands = state_.position.values()[k];
    text += fmt::format(" {}{:.10f}", kWrittenAxisLetters[k],
                        state_.offsets.value_for_axis_offset(k, stands) / state_.modes.unit(k));
  });
  pass_.block_with(block, state_.modes, text, "");
}

}  // namespace abbe
