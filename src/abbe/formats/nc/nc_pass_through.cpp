#include "abbe/formats/nc/nc_pass_through.h"

#include <fmt/format.h>

#include <bit>

#include "abbe/formats/nc/nc_expression.h"
#include "abbe/formats/nc/nc_word_text.h"
#include "abbe/formats/text/ascii_letters.h"

namespace abbe {
namespace {

std::string_view without_blanks_behind(std::string_view text) {
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t' || text.back() == '\r')) text.remove_suffix(1);
  return text;
}

/// Words of a block that do not pass, as bits by their places.
class ConsumedWords {
 public:
  explicit ConsumedWords(const NcCodedBlock& block) : block_(block) {}

  std::uint64_t bits() const { return bits_; }
  void take_place(std::uint8_t place) { bits_ |= std::uint64_t{1} << place; }
  void take(NcGroup group) {
    if (block_.has(group)) take_place(block_.places[static_cast<std::size_t>(group)]);
  }
  void take(NcMGroup group) {
    if (block_.has(group)) take_place(block_.m_places[static_cast<std::size_t>(group)]);
  }
  void take(std::string_view letters) {
    for (const char letter : letters) {
      if (block_.has(letter)) take_place(block_.index[static_cast<std::size_t>(letter - 'a')]);
    }
  }

 private:
  const NcCodedBlock& block_;
  std::uint64_t bits_ = 0;
};

/// The words of an arc, a thread or a cycle. @throws InputError for one that another code of the block uses too
void take_words_of_motion(const NcCodedBlock& block, NcCode motion, ConsumedWords& consumed) {
  const bool is_shared_q = block.code(NcGroup::path) == 640 || block.has(NcMGroup::signals) ||
                           block.has(NcMGroup::user) || block.has(NcMGroup::spindle);
  const bool is_shared_p = is_shared_q || block.code(NcGroup::non_modal) == 40 || block.has(NcMGroup::overrides);
  const auto refuse_shared = [&](char letter) {
    block.fail(letter, "two codes of this block use it", "a block of its own for one of them");
  };
  if (block.has('r') && block.is_m(NcMGroup::spindle, 19)) refuse_shared('r');
  consumed.take("ijkr");
  const bool wants_p =
      motion <= 30 || motion == 740 || motion == 820 || motion == 840 || motion == 860 || motion == 890;
  if (wants_p && block.has('p')) {
    if (is_shared_p) refuse_shared('p');
    consumed.take("p");
  }
  if ((motion == 730 || motion == 830) && block.has('q')) {
    if (is_shared_q) refuse_shared('q');
    consumed.take("q");
  }
  if (motion > 30) consumed.take("l");
}

/// The words of the motion of a block, its feed and its modes, which are written with the pieces.
void take_motion(const NcCodedBlock& block, NcCode motion, ConsumedWords& consumed) {
  if (block.axes != 0) consumed.take(kAxisLetters);
  consumed.take(NcGroup::motion);
  if (block.cancel_place != NcBlock::kNoWord) consumed.take_place(block.cancel_place);
  consumed.take(NcGroup::feed_mode);
  consumed.take(NcGroup::retract);
  consumed.take(NcGroup::arc_centre);
  const bool to_reference = block.goes_to_reference();
  const NcCode other = block.code(NcGroup::non_modal);
  if (other == 530 || other == 531 || to_reference) consumed.take(NcGroup::non_modal);
  consumed.take("f");
  consumed.take(NcMGroup::stop);
  if (motion >= 20 && motion != 800 && !to_reference && other != 531) take_words_of_motion(block, motion, consumed);
}

}  // namespace

void NcPassThrough::append_words(const NcBlock& block, std::uint64_t consumed) {
  for (std::size_t i = 0; i < block.word_count; ++i) {
    if ((consumed >> i & 1) == 0) append_nc_word(writer_.words(), block, block.words[i]);
  }
}

std::string NcPassThrough::resolved(const NcBlock& block, std::string_view comment) const {
  std::string_view inside = comment.substr(1);
  while (!inside.empty() && inside.front() == ' ') inside.remove_prefix(1);
  std::string name;
  for (std::size_t i = 0; i < inside.size() && i < 6; ++i) name += lower_case(inside[i]);
  const bool is_active = name.starts_with("debug,") || name.starts_with("print,") || name.starts_with("log,");
  if (!is_active || comment.find('#') == std::string_view::npos) return std::string(comment);
  // The control shows values of parameters here, which the corrected program does not always have.
  std::string text;
  NcExpression expression(parameters_);
  NcCursor cursor = block.cursor;
  cursor.at = comment.data();
  cursor.end = comment.data() + comment.size();
  while (cursor.at != cursor.end) {
    if (*cursor.at != '#' || cursor.at + 1 == cursor.end) {
      text += *cursor.at++;
      continue;
    }
    text += plain_nc_number(expression.read_value(cursor));
  }
  return text;
}

void NcPassThrough::comments(const NcBlock& block, bool as_lines) {
  for (const std::string_view comment : block.comments) {
    if (as_lines) {
      writer_.line(resolved(block, comment));
      continue;
    }
    std::string& comments = writer_.comments();
    if (!comments.empty()) comments += ' ';
    comments += resolved(block, comment);
  }
}

void NcPassThrough::assignments(const NcBlock& block) {
  for (const NcAssignment& assignment : block.assignments) {
    // Those of subroutines end with them; others a later program may read.
    if (assignment.number > kNcLocalParameters) {
      writer_.line(fmt::format("#{}={}", assignment.number, plain_nc_number(assignment.value)));
    } else if (assignment.number == 0 && assignment.name[0] == '_') {
      writer_.line(fmt::format("#<{}>={}", assignment.name, plain_nc_number(assignment.value)));
    }
  }
}

void NcPassThrough::stop(const NcCodedBlock& block) {
  writer_.words_as_line();
  std::string stop;
  append_nc_word(stop, block, block.word(NcMGroup::stop));
  writer_.line(stop);
}

void NcPassThrough::block(const NcCodedBlock& block, const NcModes& modes, bool has_motion, bool unit_changes) {
  ConsumedWords consumed(block);
  if (block.code(NcGroup::distance) == 910) consumed.take(NcGroup::distance);
  consumed.take(NcGroup::tilt);
  if (block.sets_plane()) consumed.take("xyzijkp");
  if (has_motion) {
    const NcCode motion = block.has(NcGroup::motion) ? block.code(NcGroup::motion) : modes.motion;
    take_motion(block, motion, consumed);
    writer_.set_number(block.number);
    if (block.word_count != static_cast<std::size_t>(std::popcount(consumed.bits()))) {
      append_words(block, consumed.bits());
    }
    if (!block.comments.empty()) comments(block, false);
    // F comes before G20 and G21 of the same block: what is written would be in the unit before.
    if (unit_changes && motion != 0) writer_.words_as_line();
  } else if (!block.is_computed && !block.is_deleted && consumed.bits() == 0 &&
             (block.comments.empty() || block.line().find('#') == std::string_view::npos)) {
    writer_.line(without_blanks_behind(block.line()));
  } else {
    writer_.set_number(block.number);
    append_words(block, consumed.bits());
    comments(block, false);
    if (writer_.words().empty() && writer_.comments().empty()) writer_.set_number({});
    writer_.words_as_line();
  }
  note_what_was_said(block, modes, has_motion);
}

void NcPassThrough::note_what_was_said(const NcCodedBlock& block, const NcModes& modes, bool has_motion) {
  if (block.code(NcGroup::distance) == 900) writer_.said_absolute();
  if (block.has(NcGroup::units)) writer_.said_units();
  if (has_motion) return;
  if (block.has(NcGroup::feed_mode)) writer_.said_feed_mode(modes.feed_mode);
  if (block.has('f')) writer_.forget_feed();
}

void NcPassThrough::block_with(const NcCodedBlock& block, const NcModes& modes, const std::string& code,
                               std::string_view replaced) {
  ConsumedWords consumed(block);
  consumed.take(kAxisLetters);
  consumed.take(replaced);
  consumed.take(NcGroup::non_modal);
  if (block.code(NcGroup::distance) == 910) consumed.take(NcGroup::distance);
  writer_.set_number(block.number);
  append_words(block, consumed.bits());
  std::string& words = writer_.words();
  if (!words.empty()) words += ' ';
  words += code;
  comments(block, false);
  writer_.words_as_line();
  note_what_was_said(block, modes, false);
}

}  // namespace abbe
