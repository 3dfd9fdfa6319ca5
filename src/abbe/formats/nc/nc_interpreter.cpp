#include "abbe/formats/nc/nc_interpreter.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "abbe/formats/nc/nc_units.h"
#include "abbe/geometry/angle_units.h"

namespace abbe {
namespace {

constexpr std::size_t kForgetEvery = std::size_t{1} << 22;
constexpr std::size_t kTellEvery = std::size_t{1} << 18;  // lines, of loops
constexpr std::size_t kLinesBetweenLooks = 256;           // at the budget
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

/// Some editors put it before a text.
std::string_view without_byte_order_mark(std::string_view text) {
  return text.starts_with(kByteOrderMark) ? text.substr(kByteOrderMark.size()) : text;
}

}  // namespace

NcInterpreter::NcInterpreter(std::string_view text, const std::string& file, const NcProgramOptions& options,
                             NcWriter& writer)
    : text_(without_byte_order_mark(text)),
      file_(file),
      options_(options),
      writer_(writer),
      expression_(parameters_),
      flow_(text_, file, parameters_, expression_, {.idle_jumps = options.most_idle_rounds}),
      reader_(file, expression_) {
  modes_.inches = modes_.feed_inches = options.inches;
  for (std::size_t k = 0; k < kAxisWords; ++k) {
    if (options.words[k]) machine_words_ |= std::uint32_t{1} << k;
    if (options.words[k] && options.start[k]) {
      position_[k] = is_rotary_word(k) ? *options.start[k] / kDegree : *options.start[k];
      known_ |= std::uint32_t{1} << k;
    }
  }
  if (options.tools) {
    tools_ = *options.tools;
    for (auto& [number, offset] : tools_) {
      for (std::size_t k = 3; k < 6; ++k) offset[k] /= kDegree;
    }
  }
  tool_ = options.tool;
  take_parameters();
  parameters_.set_system(*this);
  update_frame();
}

void NcInterpreter::take_parameters() {
  const double length = options_.parameters_in_inches ? kInch : 1;
  const auto place = [&](int first, int number, std::size_t& axis) {
    axis = static_cast<std::size_t>(number - first);
    return number >= first && number < first + static_cast<int>(kAxisWords);
  };
  bool axis_offset_on = false;
  for (const auto& parameter : options_.parameters) {
    const int number = parameter.first;
    const double value = parameter.second;
    const InputError::Place where{.file = file_, .field = fmt::format("#{}", number)};
    if (number < 1 || number >= kNcParameters || !(std::abs(value) <= 1e9)) {
      throw InputError(where, "is not a parameter that can be set", "a number from 1 to 5601 and a value up to 1e9");
    }
    if (NcParameters::is_of_control(number)) continue;
    std::size_t axis = 0;
    const auto scaled = [&] { return is_rotary_word(axis) ? value : value * length; };
    bool taken = false;
    for (std::size_t i = 0; i < 2; ++i) {
      if (!place(i == 0 ? 5161 : 5181, number, axis)) continue;
      home_[i].value[axis] = scaled();
      home_[i].known |= std::uint32_t{1} << axis;
      taken = true;
    }
    if (place(5211, number, axis)) {
      stored_axis_offset_[axis] = scaled();
      taken = true;
    }
    for (std::size_t s = 0; s < systems_.size(); ++s) {
      const int first = 5221 + 20 * static_cast<int>(s);
      if (place(first, number, axis)) {
        systems_[s][axis] = scaled();
        system_is_said_[s] = true;
        taken = true;
      }
      if (number == first + 9) {
        if (value != 0) {
          throw InputError(where, "a work offset that is rotated is not handled", "0");
        }
        taken = true;
      }
    }
    if (number == 5210) {
      axis_offset_on = value != 0;
      taken = true;
    }
    if (number == 5220) {
      if (!(value >= 1 && value <= 9)) throw InputError(where, "is not a work offset", "1 (G54) to 9 (G59.3)");
      modes_.system = static_cast<std::size_t>(std::lround(value)) - 1;
      taken = true;
    }
    if (!taken) parameters_.set(number, value);
  }
  if (axis_offset_on) axis_offset_ = stored_axis_offset_;
}

std::size_t NcInterpreter::run(const std::function<void(std::size_t)>& read_to) {
  std::string_view line;
  std::size_t number = 0, lines = 0, told = 0;
  bool percent = false;
  while (flow_.next_line(line, number)) {
    ++lines;
    line_ = number;
    if (lines % kLinesBetweenLooks == 0) refuse_spent_budget(options_);
    if (read_to && (flow_.offset() > told + kForgetEvery || lines % kTellEvery == 0)) {
      read_to(told = std::max(told, flow_.offset()));
    }
    reader_.read(line, number, block_);
    if (block_.is_percent) {
      writer_.line("%");
      if (percent) break;
      percent = true;
      continue;
    }
    if (block_.is_deleted && options_.block_delete) continue;
    if (block_.flow != NcFlowWord::none) {
      flow_.run(block_);
      const char next = block_.cursor.peek();
      if (next == '(' || next == ';') {
        reader_.read({block_.cursor.at, static_cast<std::size_t>(block_.cursor.end - block_.cursor.at)}, number,
                     block_);
        pass_comments(true);
      }
      continue;
    }
    execute();
    if (codes_.has(NcMGroup::stop) && ends_program()) {
      // Nothing behind it runs; the percent sign closes the file as it opened it.
      if (percent) writer_.line("%");
      break;
    }
  }
  return lines;
}

bool NcInterpreter::ends_program() const {
  const double code = codes_.word(block_, NcMGroup::stop).value;
  return code == 2 || code == 30;
}

void NcInterpreter::execute() {
  sort_nc_codes(block_, codes_);
  check_words();
  if (tilt_.on || codes_.has(NcGroup::tilt) || codes_[NcGroup::non_modal] == 531) check_plane_words();
  const NcCode other = codes_[NcGroup::non_modal];
  const NcCode tool_length = codes_[NcGroup::tool_length];
  // Who takes the axis words.
  const bool sets_plane = codes_[NcGroup::tilt] == 682;
  const bool sets_offset = other == 100 || other == 520 || other == 920;
  const bool to_reference = other == 280 || other == 300;
  const bool dynamic_tool = tool_length == 431 || (tool_length == 432 && !block_.has('h'));
  const bool has_axes = codes_.axes != 0;
  if (sets_offset || to_reference || (dynamic_tool && has_axes)) {
    if (codes_.has(NcGroup::motion) && codes_[NcGroup::motion] != 800) {
      block_.fail(codes_.word(block_, NcGroup::motion), "two codes of this block use the axis words");
    }
    if (static_cast<int>(sets_offset) + static_cast<int>(to_reference) + static_cast<int>(dynamic_tool) > 1) {
      block_.fail(codes_.word(block_, NcGroup::tool_length), "two codes of this block use the axis words");
    }
  }
  const bool free_axes = has_axes && !sets_plane && !sets_offset && !to_reference && !dynamic_tool;
  NcCode motion = kNoCode;
  if (free_axes || (codes_.has(NcGroup::motion) && codes_[NcGroup::motion] >= 20 && codes_[NcGroup::motion] != 800)) {
    motion = codes_.has(NcGroup::motion) ? codes_[NcGroup::motion] : modes_.motion;
    if (motion == 800) {
      const auto first = static_cast<std::size_t>(std::countr_zero(codes_.axes));
      block_.fail("xyzabcuvw"[first], "axis words without a code that uses them", "G0, G1, G2, G3 or a canned cycle");
    }
  }
  // An arc goes on with its centre alone: a full circle.
  if (!has_axes && !sets_plane && motion == kNoCode && !codes_.has(NcGroup::motion) && modes_.motion >= 20 &&
      modes_.motion <= 30 && (block_.has('i') || block_.has('j') || block_.has('k'))) {
    motion = modes_.motion;
  }
  if (codes_.has(NcMGroup::stop)) {
    const NcWord& word = codes_.word(block_, NcMGroup::stop);
    if (word.value == 98 || word.value == 99) {
      for (std::size_t i = 0; i < block_.word_count; ++i) {
        const NcWord& beside = block_.words[i];
        if (&beside == &word || (word.value == 98 && (beside.letter == 'p' || beside.letter == 'l'))) continue;
        block_.fail(beside, "is given together with M98 or M99, which have no other words",
                    "a block of its own before it");
      }
      if (!block_.assignments.empty()) {
        block_.fail(word, "a parameter is set beside M98 or M99", "a block of its own before it");
      }
      pass_comments(true);
      if (word.value == 98) {
        if (!block_.has('p')) block_.fail(word, "the number of the subprogram is missing", "P");
        flow_.call_subprogram(block_, word, block_.value('p'), block_.has('l') ? block_.value('l') : 1);
      } else {
        flow_.end_subprogram(block_, word);
      }
      return;
    }
  }
  // The words have been read; comments say what the parameters are now, as in LinuxCNC 2.9.
  if (!block_.assignments.empty()) apply_assignments();
  set_feed();
  if (block_.has('s')) spindle_speed_ = block_.value('s');
  if (block_.has('t')) selected_tool_ = static_cast<int>(std::lround(block_.value('t')));
  if (codes_.has(NcMGroup::tool)) {
    const NcWord& word = codes_.word(block_, NcMGroup::tool);
    if (word.value == 6) {
      tool_ = selected_tool_;
      spindle_ = 0;  // LinuxCNC 2.9 stops it for the change
    } else if (block_.has('q')) {
      tool_ = static_cast<int>(std::lround(block_.value('q')));
    }
  }
  if (codes_.has(NcMGroup::spindle)) {
    const double code = codes_.word(block_, NcMGroup::spindle).value;
    spindle_ = code == 3 || code == 4 ? static_cast<int>(code) : 0;
  }
  if (codes_.has(NcMGroup::overrides)) {
    const double code = codes_.word(block_, NcMGroup::overrides).value;
    if (code == 48 || code == 49) overrides_ = code == 48;
  }
  if (other == 40) {
    if (!block_.has('p'))
      block_.fail(codes_.word(block_, NcGroup::non_modal), "the time of the dwell is missing", "P in s");
    if (block_.value('p') < 0) block_.fail('p', "the time of the dwell is negative");
  }
  const bool was_in_inches = modes_.inches;
  set_modes();
  if (codes_.has(NcGroup::tilt)) set_plane();
  set_tool_length();
  if (codes_.has(NcGroup::work_offset)) {
    const NcCode code = codes_[NcGroup::work_offset];
    modes_.system = static_cast<std::size_t>(code < 590 ? (code - 540) / 10 : code - 585);
    update_frame();
  }
  const bool turns_to_plane = other == 531;
  const bool moves = motion != kNoCode || to_reference || turns_to_plane;
  if (codes_[NcGroup::non_modal] == 530 && (motion == kNoCode || motion > 10)) {
    block_.fail(codes_.word(block_, NcGroup::non_modal), "G53 is not followed by a straight move", "G0 or G1");
  }
  if (other == 100 || (other >= 920 && other <= 923) || other == 520) {
    set_origin(moves);
  } else {
    if (other == 281 || other == 301) {
      // What is stored is a place of the axes, and only the kinematics of the machine could say where they stand.
      if (modes_.tool_centre) {
        block_.fail(codes_.word(block_, NcGroup::non_modal), "a reference position while tool centre control is on",
                    "G49 before it");
      }
      if ((machine_words_ & ~known_) != 0) fail_unknown(machine_words_ & ~known_, "G28.1 and G30.1 store it");
      home_[other == 281 ? 0 : 1] = {position_, machine_words_};
    }
    if (turns_to_plane) block_.comments.push_back("(G53.1)");
    pass_block(moves, modes_.inches != was_in_inches);
  }
  if (to_reference) go_to_reference();
  if (turns_to_plane) turn_to_plane();
  if (motion != kNoCode) move_by_word(motion);
  if (codes_.has(NcGroup::motion)) modes_.motion = codes_[NcGroup::motion];
  if (moves && codes_.has(NcMGroup::stop)) {
    // A stop holds when the motion is done, behind its last piece.
    writer_.words_as_line();
    std::string stop;
    append_word(stop, codes_.word(block_, NcMGroup::stop));
    writer_.line(stop);
  }
}

void NcInterpreter::apply_assignments() {
  double ignored = 0;
  for (const NcAssignment& assignment : block_.assignments) {
    if (assignment.number > 0) {
      parameters_.set(assignment.number, assignment.value);
    } else {
      if (named(assignment.name, ignored)) {
        throw InputError({file_, block_.cursor.line, 0, "#<" + assignment.name + ">"},
                         "this parameter belongs to the control");
      }
      parameters_.set(assignment.name, assignment.value);
    }
  }
  pass_assignments();
}

bool NcInterpreter::numbered(int number, double& value) const {
  const double length = options_.parameters_in_inches ? kInch : 1;
  const auto axis_of = [&](int first) { return static_cast<std::size_t>(number - first); };
  const auto in = [&](int first) { return number >= first && number < first + static_cast<int>(kAxisWords); };
  const auto stored = [&](double position, std::size_t axis) {
    return is_rotary_word(axis) ? position : position / length;
  };
  for (std::size_t i = 0; i < 2; ++i) {
    const int first = i == 0 ? 5161 : 5181;
    if (!in(first)) continue;
    value = stored(home_[i].value[axis_of(first)], axis_of(first));
    return (home_[i].known >> axis_of(first) & 1) != 0;
  }
  if (in(5211)) {
    value = stored(stored_axis_offset_[axis_of(5211)], axis_of(5211));
    return true;
  }
  if (number == 5220) {
    value = static_cast<double>(modes_.system) + 1;
    return true;
  }
  for (std::size_t s = 0; s < systems_.size(); ++s) {
    const int first = 5221 + 20 * static_cast<int>(s);
    if (in(first)) {
      value = stored(systems_[s][axis_of(first)], axis_of(first));
      return true;
    }
  }
  if (number == 5400 && tool_) {
    value = *tool_;
    return true;
  }
  if (in(5420)) {
    const std::size_t axis = axis_of(5420);
    value = (position_[axis] - offset_[axis]) / unit(axis);
    return (known_ >> axis & 1) != 0;
  }
  return false;
}

bool NcInterpreter::named(std::string_view name, double& value) const {
  if (name.size() == 2) {
    const std::size_t axis = nc_axis(name[1]);
    return axis < kAxisWords && numbered(5420 + static_cast<int>(axis), value);
  }
  const auto say = [&](double said) {
    value = said;
    return true;
  };
  if (name == "_line") return say(static_cast<double>(block_.cursor.line));
  // In inverse time LinuxCNC 2.9 says the speed of the last move instead, and its documentation F.
  if (name == "_feed" && modes_.feed_mode != FeedMode::inverse_time) return say(modes_.feed);
  if (name == "_metric") return say(modes_.inches ? 0 : 1);
  if (name == "_imperial") return say(modes_.inches ? 1 : 0);
  if (name == "_absolute") return say(modes_.absolute ? 1 : 0);
  if (name == "_incremental") return say(modes_.absolute ? 0 : 1);
  if (name == "_inverse_time") return say(modes_.feed_mode == FeedMode::inverse_time ? 1 : 0);
  if (name == "_units_per_minute") return say(modes_.feed_mode == FeedMode::per_minute ? 1 : 0);
  if (name == "_units_per_rev") return say(modes_.feed_mode == FeedMode::per_revolution ? 1 : 0);
  if (name == "_motion_mode") return say(modes_.motion);
  if (name == "_plane") return say(modes_.plane == ArcPlane::XY ? 170 : modes_.plane == ArcPlane::ZX ? 180 : 190);
  if (name == "_coord_system")
    return say(modes_.system < 6 ? 540 + 10.0 * static_cast<double>(modes_.system)
                                 : 585 + static_cast<double>(modes_.system));
  if (name == "_current_tool" && tool_) return say(*tool_);
  if (name == "_selected_tool" && selected_tool_) return say(*selected_tool_);
  return false;
}

}  // namespace abbe
