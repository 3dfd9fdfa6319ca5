// Units, feeds and offsets of an NC program.
#include <fmt/format.h>

#include <cmath>

#include "abbe/formats/nc/nc_interpreter.h"
#include "abbe/formats/nc/nc_units.h"

namespace abbe {

double NcInterpreter::unit(std::size_t axis) const { return modes_.inches && !is_rotary_word(axis) ? kInch : 1; }

void NcInterpreter::set_feed() {
  if (codes_.has(NcGroup::feed_mode)) {
    const NcCode code = codes_[NcGroup::feed_mode];
    const FeedMode mode = code == 930   ? FeedMode::inverse_time
                          : code == 940 ? FeedMode::per_minute
                                        : FeedMode::per_revolution;
    // A feed of another kind is none.
    if (mode != modes_.feed_mode) modes_.feed = 0;
    modes_.feed_mode = mode;
  }
  if (block_.has('f')) {
    modes_.feed = block_.value('f');
    // As LinuxCNC does: F comes before G20 and G21 of the same block.
    modes_.feed_inches = modes_.inches;
  }
}

void NcInterpreter::set_modes() {
  if (codes_.has(NcGroup::plane)) {
    const NcCode code = codes_[NcGroup::plane];
    modes_.plane = code == 170 ? ArcPlane::XY : code == 180 ? ArcPlane::ZX : ArcPlane::YZ;
  }
  if (codes_.has(NcGroup::units)) {
    const bool inches = codes_[NcGroup::units] == 200;
    if (inches != modes_.inches) {
      modes_.inches = inches;
      update_frame();
    }
  }
  if (codes_.has(NcGroup::path)) {
    modes_.exact_path = codes_[NcGroup::path] == 610;
    modes_.stops_in_corners = codes_[NcGroup::path] == 611;
    path_words_.clear();
    append_word(path_words_, codes_.word(block_, NcGroup::path));
    for (const char letter : {'p', 'q'}) {
      if (codes_[NcGroup::path] == 640 && block_.has(letter)) append_word(path_words_, block_.word(letter));
    }
    writer_.set_path(codes_[NcGroup::path] == 640 ? path_words_ : "");
  }
  if (codes_.has(NcGroup::distance)) modes_.absolute = codes_[NcGroup::distance] == 900;
  if (codes_.has(NcGroup::arc_centre)) modes_.arc_absolute = codes_[NcGroup::arc_centre] == 901;
  if (codes_.has(NcGroup::retract)) modes_.retract_to_r = codes_[NcGroup::retract] == 990;
}

NcInterpreter::Words NcInterpreter::offsets_in_force() const {
  Words offset{};
  for (std::size_t k = 0; k < kAxisWords; ++k) {
    offset[k] = systems_[modes_.system][k] + axis_offset_[k];
    if (!modes_.tool_centre) offset[k] += tool_offset_[k];
  }
  return offset;
}

void NcInterpreter::update_frame() {
  NcProgramFrame frame;
  offset_ = offsets_in_force();
  frame.offset = offset_;
  for (std::size_t k = 0; tilt_.on && k < 3; ++k) offset_[k] = 0;
  frame.inches = modes_.inches;
  writer_.set_frame(frame);
}

void NcInterpreter::set_tool_centre(bool on) {
  if (on == modes_.tool_centre) return;
  modes_.tool_centre = on;
  // Where the functional point stands in the workpiece the kinematics of the machine say, which are not known here.
  known_ &= ~std::uint32_t{7};
  writer_.forget_linear_axes();
}

const NcInterpreter::Words& NcInterpreter::tool_offset(const NcWord& word) {
  if (!options_.tools) {
    block_.fail(word, "there is no tool table", "a tool table, or the length in the program by G43.1");
  }
  const bool has_number = block_.has('h');
  if (has_number && (block_.value('h') < 0 || std::abs(block_.value('h') - std::round(block_.value('h'))) > 1e-4)) {
    block_.fail('h', "is not the number of a tool");
  }
  if (!has_number && !tool_)
    block_.fail(word, "it is not known which tool is in the spindle", "H, or T and M6 before it");
  const int number = has_number ? static_cast<int>(std::lround(block_.value('h'))) : *tool_;
  const auto tool = tools_.find(number);
  if (tool == tools_.end()) {
    block_.fail(has_number ? block_.word('h') : word, fmt::format("the tool table has no tool {}", number));
  }
  return tool->second;
}

void NcInterpreter::set_tool_length() {
  if (!codes_.has(NcGroup::tool_length)) return;
  const NcCode code = codes_[NcGroup::tool_length];
  const NcWord& word = codes_.word(block_, NcGroup::tool_length);
  if (tilt_.on) leave_plane();
  switch (code) {
    case 490:
      tool_offset_ = {};
      break;
    case 430:
    case 434:
      tool_offset_ = tool_offset(word);
      break;
    case 431:
    case 432: {
      if (code == 432 && block_.has('h') == (codes_.axes != 0)) {
        block_.fail(word, "the offset that is added is not said", "H, or axis words");
      }
      if (code == 431 && codes_.axes == 0) block_.fail(word, "the offset of the tool is missing", "axis words");
      Words added{};
      if (code == 432 && block_.has('h')) {
        added = tool_offset(word);
      } else {
        for (std::size_t k = 0; k < kAxisWords; ++k) {
          if ((codes_.axes >> k & 1) != 0) added[k] = block_.value("xyzabcuvw"[k]) * unit(k);
        }
      }
      for (std::size_t k = 0; k < kAxisWords; ++k) {
        if (code == 432) {
          tool_offset_[k] += added[k];
        } else if ((codes_.axes >> k & 1) != 0) {
          tool_offset_[k] = added[k];
        }
      }
      break;
    }
    default:
      break;
  }
  if (code == 490 || code == 434) set_tool_centre(code == 434);
  if (code != 490 && code != 434 && modes_.tool_centre) {
    block_.fail(word, "another tool length while tool centre control is on", "G49 before it");
  }
  update_frame();
  if (tilt_.on) enter_plane();
}

void NcInterpreter::set_origin(bool moves) {
  const NcCode code = codes_[NcGroup::non_modal];
  if (code != 100) {
    set_axis_offset(moves);
    return;
  }
  const NcWord& word = codes_.word(block_, NcGroup::non_modal);
  const double kind = block_.has('l') ? block_.value('l') : -1;
  if (kind != 1 && kind != 2 && kind != 20) {
    block_.fail(block_.has('l') ? block_.word('l') : word, "is not a G10 that is handled", "L1, L2 or L20");
  }
  if (!block_.has('p')) block_.fail(word, "P is missing", kind == 1 ? "the tool" : "0 (current) to 9 (G59.3)");
  const double written = block_.value('p');
  if (std::abs(written - std::round(written)) > 1e-4) block_.fail('p', "is not a whole number");
  const auto number = static_cast<int>(std::lround(written));
  if (kind == 1) {
    if (!options_.tools) block_.fail(word, "there is no tool table");
    const auto found = tools_.find(number);
    if (found == tools_.end()) block_.fail('p', fmt::format("the tool table has no tool {}", number));
    Words& tool = found->second;
    for (std::size_t k = 0; k < kAxisWords; ++k) {
      if ((codes_.axes >> k & 1) != 0) tool[k] = block_.value("xyzabcuvw"[k]) * unit(k);
    }
    pass_block(false);
    return;
  }
  if (number < 0 || number > 9) block_.fail('p', "is not a work offset", "0 (current) to 9 (G59.3)");
  if (block_.has('r') && block_.value('r') != 0) block_.fail('r', "a rotated work offset is not handled");
  const std::size_t system = number == 0 ? modes_.system : static_cast<std::size_t>(number - 1);
  system_is_said_[system] = true;
  if (kind == 2) {
    for (std::size_t k = 0; k < kAxisWords; ++k) {
      if ((codes_.axes >> k & 1) != 0) systems_[system][k] = block_.value("xyzabcuvw"[k]) * unit(k);
    }
    pass_block(false);
  } else {
    if ((codes_.axes & ~known_) != 0) fail_unknown(codes_.axes & ~known_, "G10 L20 takes it");
    // The control stands where the correction has put it: it is told the offset itself.
    std::string text = fmt::format("G10 L2 P{}", system + 1);
    for (std::size_t k = 0; k < kAxisWords; ++k) {
      if ((codes_.axes >> k & 1) == 0) continue;
      systems_[system][k] = position_[k] - axis_offset_[k] - (modes_.tool_centre ? 0 : tool_offset_[k]) -
                            block_.value("xyzabcuvw"[k]) * unit(k);
      text += fmt::format(" {}{:.10f}", "XYZABCUVW"[k], systems_[system][k] / unit(k));
    }
    pass_block_with(text, "lp");
  }
  if (system == modes_.system) update_frame();
}

void NcInterpreter::set_axis_offset(bool moves) {
  const NcCode code = codes_[NcGroup::non_modal];
  const NcWord& word = codes_.word(block_, NcGroup::non_modal);
  if ((code == 920 || code == 520) && codes_.axes == 0) block_.fail(word, "axis words are missing");
  switch (code) {
    case 520:
      for (std::size_t k = 0; k < kAxisWords; ++k) {
        if ((codes_.axes >> k & 1) != 0) axis_offset_[k] = block_.value("xyzabcuvw"[k]) * unit(k);
      }
      stored_axis_offset_ = axis_offset_;
      break;
    case 920:
      if ((codes_.axes & ~known_) != 0) fail_unknown(codes_.axes & ~known_, "G92 takes it");
      for (std::size_t k = 0; k < kAxisWords; ++k) {
        if ((codes_.axes >> k & 1) != 0) {
          axis_offset_[k] += position_[k] - offset_[k] - block_.value("xyzabcuvw"[k]) * unit(k);
        }
      }
      stored_axis_offset_ = axis_offset_;
      write_axis_offset();
      break;
    case 921:
      axis_offset_ = stored_axis_offset_ = {};
      break;
    case 922:
      axis_offset_ = {};
      break;
    default:
      axis_offset_ = stored_axis_offset_;
      break;
  }
  if (code != 920) pass_block(moves);
  update_frame();
}

void NcInterpreter::write_axis_offset() {
  // The control stands where the correction has put it, not where the program has sent it: the words say what leads to
  // the same offset from there.
  writer_.flush();
  std::string text = "G92";
  for (std::size_t k = 0; k < kAxisWords; ++k) {
    if ((codes_.axes >> k & 1) == 0) continue;
    double stands = 0;
    if (!writer_.position(k, stands)) stands = position_[k];
    const double base = systems_[modes_.system][k] + (modes_.tool_centre ? 0 : tool_offset_[k]);
    text += fmt::format(" {}{:.10f}", "XYZABCUVW"[k], (stands - base - axis_offset_[k]) / unit(k));
  }
  pass_block_with(text, "");
}

}  // namespace abbe
