#include "abbe/formats/nc/nc_interpreter.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "abbe/formats/nc/nc_check_words.h"
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
      reader_(file, expression_),
      state_(options),
      system_parameters_(state_, block_, options.parameters_in_inches),
      pass_(writer, parameters_),
      moves_(state_, flow_, writer, file, options),
      cycles_(state_, moves_, writer),
      origin_(state_, pass_, writer) {
  take_nc_parameters(options, file, state_, parameters_);
  parameters_.set_system(system_parameters_);
  update_frame();
}

std::size_t NcInterpreter::run(const std::function<void(std::size_t)>& read_to) {
  std::string_view line;
  std::size_t lines = 0, told = 0;
  bool percent = false;
  while (flow_.next_line(line, line_)) {
    ++lines;
    if (lines % kLinesBetweenLooks == 0) refuse_spent_budget(options_);
    if (read_to && (flow_.offset() > told + kForgetEvery || lines % kTellEvery == 0)) {
      read_to(told = std::max(told, flow_.offset()));
    }
    reader_.read(line, line_, block_);
    if (block_.is_percent) {
      writer_.line("%");
      if (percent) break;
      percent = true;
      continue;
    }
    if (block_.is_deleted && options_.block_delete) continue;
    if (block_.flow != NcFlowWord::none) {
      run_flow();
      continue;
    }
    execute();
    if (const double stop = stop_code(); stop == 2 || stop == 30) {
      // Nothing behind it runs; the percent sign closes the file as it opened it.
      if (percent) writer_.line("%");
      break;
    }
  }
  return lines;
}

double NcInterpreter::stop_code() const {
  return block_.has(NcMGroup::stop) ? block_.word(NcMGroup::stop).value : kNoCode;
}

void NcInterpreter::run_flow() {
  flow_.run(block_);
  const NcCursor& cursor = block_.cursor;
  const char next = block_.cursor.peek();
  if (next != '(' && next != ';') return;
  reader_.read({cursor.at, static_cast<std::size_t>(cursor.end - cursor.at)}, line_, block_);
  pass_.comments(block_, true);
}

void NcInterpreter::execute() {
  sort_nc_codes(block_);
  const NcCode motion = check_nc_words(block_, state_, options_.planes);
  if (const double stop = stop_code(); stop == 98 || stop == 99) {
    run_subprogram_code();
    return;
  }
  // The words have been read; comments say what the parameters are now, as in LinuxCNC 2.9.
  if (!block_.assignments.empty()) apply_assignments();
  const bool was_in_inches = state_.modes.inches;
  set_modes();
  if (block_.has(NcGroup::tilt)) set_plane();
  if (block_.has(NcGroup::tool_length)) set_tool_length();
  if (block_.has(NcGroup::work_offset)) {
    const NcCode code = block_.code(NcGroup::work_offset);
    state_.offsets.use_system(static_cast<std::size_t>(code < 590 ? (code - 540) / 10 : code - 585));
    update_frame();
  }
  const NcCode other = block_.code(NcGroup::non_modal);
  const bool turns_to_plane = other == 531, to_reference = block_.goes_to_reference();
  const bool moves = motion != kNoCode || to_reference || turns_to_plane;
  if (other == 530 && (motion == kNoCode || motion > 10)) {
    block_.fail(block_.word(NcGroup::non_modal), "G53 is not followed by a straight move", "G0 or G1");
  }
  if (block_.sets_offset() || (other >= 921 && other <= 923)) {
    if (origin_.run(block_, moves)) update_frame();
  } else {
    if (other == 281 || other == 301) set_reference();
    if (turns_to_plane) block_.comments.push_back("(G53.1)");
    pass_.block(block_, state_.modes, moves, state_.modes.inches != was_in_inches);
  }
  if (to_reference) moves_.reference(block_);
  if (turns_to_plane) moves_.turn_to_plane(block_);
  if (motion != kNoCode) move(motion);
  if (block_.has(NcGroup::motion)) state_.modes.motion = block_.code(NcGroup::motion);
  if (moves && block_.has(NcMGroup::stop)) pass_.stop(block_);
}

void NcInterpreter::run_subprogram_code() {
  const NcWord& word = block_.word(NcMGroup::stop);
  check_subprogram_words(block_, word);
  pass_.comments(block_, true);
  if (word.value == 98) {
    if (!block_.has('p')) block_.fail(word, "the number of the subprogram is missing", "P");
    flow_.call_subprogram(block_, word, block_.value('p'), block_.has('l') ? block_.value('l') : 1);
  } else {
    flow_.end_subprogram(block_, word);
  }
}

void NcInterpreter::apply_assignments() {
  double ignored = 0;
  for (const NcAssignment& assignment : block_.assignments) {
    if (assignment.number > 0) {
      parameters_.set(assignment.number, assignment.value);
    } else {
      if (system_parameters_.named(assignment.name, ignored)) {
        throw InputError({file_, block_.cursor.line, 0, "#<" + assignment.name + ">"},
                         "this parameter belongs to the control");
      }
      parameters_.set(assignment.name, assignment.value);
    }
  }
  pass_.assignments(block_);
}

void NcInterpreter::set_modes() {
  NcModes& modes = state_.modes;
  modes.take_feed(block_);
  state_.tools.take(block_);
  state_.spindle.take(block_);
  if (block_.code(NcGroup::non_modal) == 40) {
    if (!block_.has('p')) {
      block_.fail(block_.word(NcGroup::non_modal), "the time of the dwell is missing", "P in s");
    }
    if (block_.value('p') < 0) block_.fail('p', "the time of the dwell is negative");
  }
  const bool was_in_inches = modes.inches;
  modes.take(block_);
  if (modes.inches != was_in_inches) update_frame();
  if (block_.has(NcGroup::path)) {
    state_.path.take(block_);
    writer_.set_path(state_.path.rounding_block());
  }
}

void NcInterpreter::set_plane() {
  NcPosition& position = state_.position;
  if (!block_.sets_plane()) {
    position.set_plane(std::nullopt);
    update_frame();
    return;
  }
  const auto angle = [&](char letter) { return block_.has(letter) ? block_.value(letter) * kDegree : 0.0; };
  const auto length = [&](std::size_t k) { return block_.has_axis(k) ? state_.modes.length(block_, k) : 0.0; };
  position.set_plane(NcTiltedPlane({length(0), length(1), length(2)}, {angle('i'), angle('j'), angle('k')}));
  update_frame();
  moves_.enter_plane(block_);
  plane_comment_ = "(G68.2";
  for (const char letter : {'x', 'y', 'z', 'i', 'j', 'k'}) {
    if (!block_.has(letter)) continue;
    plane_comment_ += fmt::format(" {}{:.10g}", static_cast<char>(letter - 'a' + 'A'), block_.value(letter));
  }
  plane_comment_ += ", until G69 written as moves of the axes)";
  block_.comments.push_back(plane_comment_);
}

void NcInterpreter::set_tool_length() {
  NcOffsets& offsets = state_.offsets;
  NcPosition& position = state_.position;
  position.leave_plane();
  offsets.set_tool(state_.tools.offset(block_, state_.modes, offsets.tool()));
  const NcCode code = block_.code(NcGroup::tool_length);
  const bool tool_centre = code == 434;
  if (code != 490 && !tool_centre && offsets.tool_centre()) {
    block_.fail(block_.word(NcGroup::tool_length), "another tool length while tool centre control is on",
                "G49 before it");
  }
  if (tool_centre != offsets.tool_centre()) {
    offsets.set_tool_centre(tool_centre);
    // Where the functional point stands in the workpiece the kinematics of the machine say, which are not known here.
    position.forget(kXyzWords);
    writer_.forget_linear_axes();
  }
  update_frame();
  if (position.plane()) moves_.enter_plane(block_);
}

void NcInterpreter::update_frame() {
  const NcAxisValues sum = state_.offsets.sum();
  state_.position.count_from(sum);
  writer_.set_frame({.offset = sum, .inches = state_.modes.inches});
}

void NcInterpreter::set_reference() {
  const NcPosition& position = state_.position;
  const NcCode code = block_.code(NcGroup::non_modal);
  // What is stored is a place of the axes, and only the kinematics of the machine could say where they stand.
  if (state_.offsets.tool_centre()) {
    block_.fail(block_.word(NcGroup::non_modal), "a reference position while tool centre control is on",
                "G49 before it");
  }
  position.require(position.machine_words(), block_, "G28.1 and G30.1 store it");
  state_.references[code == 281 ? 0 : 1] = {position.values(), position.machine_words()};
}

void NcInterpreter::move(NcCode motion) {
  if (motion < 20) {
    moves_.line(block_, motion);
  } else if (motion <= 30) {
    moves_.arc(block_, motion);
  } else if (motion == 330 || motion == 331) {
    moves_.thread(block_, motion);
  } else {
    cycles_.run(block_, motion);
  }
}

}  // namespace abbe
