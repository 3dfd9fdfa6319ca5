// What of a program passes to the control as it stands, or as what it results in.
#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "abbe/formats/nc/nc_interpreter.h"
#include "abbe/formats/text/ascii_letters.h"

namespace abbe {
namespace {

/// A value with at most 10 decimals and no exponent, which NC programs do not have.
std::string plain_number(double value) {
  std::string text = fmt::format("{:.10f}", value);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text == "-0" ? "0" : text;
}

bool is_plain(const NcWord& word) {
  return std::none_of(word.begin + 1, word.end, [](char c) { return c == '[' || c == '#' || is_letter(c); });
}

std::string_view without_blanks_behind(std::string_view text) {
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t' || text.back() == '\r')) text.remove_suffix(1);
  return text;
}

}  // namespace

void NcInterpreter::append_word(std::string& text, const NcWord& word) const {
  if (!text.empty()) text += ' ';
  if (!block_.is_computed || is_plain(word)) {
    text.append(word.begin, word.end);
    while (text.back() == ' ' || text.back() == '\t') text.pop_back();
    return;
  }
  text += static_cast<char>(word.letter - 'a' + 'A');
  text += plain_number(word.value);
}

void NcInterpreter::append_words(std::uint64_t consumed) {
  for (std::size_t i = 0; i < block_.word_count; ++i) {
    if ((consumed >> i & 1) == 0) append_word(writer_.words(), block_.words[i]);
  }
}

std::string NcInterpreter::resolved_comment(std::string_view comment) const {
  std::string_view inside = comment.substr(1);
  while (!inside.empty() && inside.front() == ' ') inside.remove_prefix(1);
  std::string name;
  for (std::size_t i = 0; i < inside.size() && i < 6; ++i) name += lower_case(inside[i]);
  const bool is_active = name.starts_with("debug,") || name.starts_with("print,") || name.starts_with("log,");
  if (!is_active || comment.find('#') == std::string_view::npos) return std::string(comment);
  // The control shows values of parameters here, which the corrected program does not always have.
  std::string text;
  NcExpression expression(parameters_);
  NcCursor cursor = block_.cursor;
  cursor.at = comment.data();
  cursor.end = comment.data() + comment.size();
  while (cursor.at != cursor.end) {
    if (*cursor.at != '#' || cursor.at + 1 == cursor.end) {
      text += *cursor.at++;
      continue;
    }
    text += plain_number(expression.read_value(cursor));
  }
  return text;
}

void NcInterpreter::pass_comments(bool as_lines) {
  for (const std::string_view comment : block_.comments) {
    if (as_lines) {
      writer_.line(resolved_comment(comment));
      continue;
    }
    std::string& comments = writer_.comments();
    if (!comments.empty()) comments += ' ';
    comments += resolved_comment(comment);
  }
}

void NcInterpreter::pass_assignments() {
  for (const NcAssignment& assignment : block_.assignments) {
    // Those of subroutines end with them; others a later program may read.
    if (assignment.number > kNcLocalParameters) {
      writer_.line(fmt::format("#{}={}", assignment.number, plain_number(assignment.value)));
    } else if (assignment.number == 0 && assignment.name[0] == '_') {
      writer_.line(fmt::format("#<{}>={}", assignment.name, plain_number(assignment.value)));
    }
  }
}

void NcInterpreter::pass_block(bool has_motion, bool unit_changes) {
  const auto bit = [](std::uint8_t i) { return std::uint64_t{1} << i; };
  std::uint64_t consumed = 0;
  const auto drop = [&](NcGroup group) {
    if (codes_.has(group)) consumed |= bit(codes_.place[static_cast<std::size_t>(group)]);
  };
  const auto drop_letter = [&](char letter) {
    if (block_.has(letter)) consumed |= bit(block_.index[static_cast<std::size_t>(letter - 'a')]);
  };
  if (codes_[NcGroup::distance] == 910) drop(NcGroup::distance);
  drop(NcGroup::tilt);
  if (codes_[NcGroup::tilt] == 682) {
    for (const char letter : {'x', 'y', 'z', 'i', 'j', 'k', 'p'}) drop_letter(letter);
  }
  if (has_motion) {
    if (codes_.axes != 0) {
      for (const char letter : {'x', 'y', 'z', 'a', 'b', 'c', 'u', 'v', 'w'}) drop_letter(letter);
    }
    drop(NcGroup::motion);
    if (codes_.cancel_place != NcBlock::kNoWord) consumed |= bit(codes_.cancel_place);
    drop(NcGroup::feed_mode);
    drop(NcGroup::retract);
    drop(NcGroup::arc_centre);
    const NcCode other = codes_[NcGroup::non_modal];
    if (other == 530 || other == 531 || other == 280 || other == 300) drop(NcGroup::non_modal);
    drop_letter('f');
    if (codes_.has(NcMGroup::stop)) consumed |= bit(codes_.m_place[static_cast<std::size_t>(NcMGroup::stop)]);
    const NcCode motion = codes_.has(NcGroup::motion) ? codes_[NcGroup::motion] : modes_.motion;
    if (motion >= 20 && motion != 800 && other != 280 && other != 300 && other != 531) {
      const bool is_shared_q = codes_[NcGroup::path] == 640 || codes_.has(NcMGroup::signals) ||
                               codes_.has(NcMGroup::user) || codes_.has(NcMGroup::spindle);
      const bool is_shared_p = is_shared_q || other == 40 || codes_.has(NcMGroup::overrides);
      if (block_.has('r') && codes_.is_m(block_, NcMGroup::spindle, 19)) {
        block_.fail('r', "two codes of this block use it", "a block of its own for one of them");
      }
      for (const char letter : {'i', 'j', 'k', 'r'}) drop_letter(letter);
      for (const char letter : {'p', 'q', 'l'}) {
        if (!block_.has(letter)) continue;
        const bool wanted = letter == 'p' ? motion <= 30 || motion == 740 || motion == 820 || motion == 840 ||
                                                motion == 860 || motion == 890
                            : letter == 'q' ? motion == 730 || motion == 830
                                            : motion > 30;
        if (wanted && (letter == 'p' ? is_shared_p : letter == 'q' && is_shared_q)) {
          block_.fail(letter, "two codes of this block use it", "a block of its own for one of them");
        }
        if (wanted) drop_letter(letter);
      }
    }
    writer_.set_number(block_.number);
    if (block_.word_count != static_cast<std::size_t>(std::popcount(consumed))) append_words(consumed);
    if (!block_.comments.empty()) pass_comments(false);
    // F comes before G20 and G21 of the same block: what is written would be in the unit before.
    if (unit_changes && motion != 0) writer_.words_as_line();
  } else if (!block_.is_computed && !block_.is_deleted && consumed == 0 &&
             (block_.comments.empty() || block_.line().find('#') == std::string_view::npos)) {
    writer_.line(without_blanks_behind(block_.line()));
  } else {
    writer_.set_number(block_.number);
    append_words(consumed);
    pass_comments(false);
    if (writer_.words().empty() && writer_.comments().empty()) writer_.set_number({});
    writer_.words_as_line();
  }
  note_what_was_said(has_motion);
}

void NcInterpreter::note_what_was_said(bool has_motion) {
  if (codes_[NcGroup::distance] == 900) writer_.said_absolute();
  if (codes_.has(NcGroup::units)) writer_.said_units();
  if (has_motion) return;
  if (codes_.has(NcGroup::feed_mode)) writer_.said_feed_mode(modes_.feed_mode);
  if (block_.has('f')) writer_.forget_feed();
}

void NcInterpreter::pass_block_with(const std::string& code, std::string_view replaced) {
  std::uint64_t consumed = 0;
  for (std::size_t i = 0; i < block_.word_count; ++i) {
    const NcWord& word = block_.words[i];
    if (nc_axis(word.letter) < kAxisWords || replaced.find(word.letter) != std::string_view::npos) {
      consumed |= std::uint64_t{1} << i;
    }
  }
  const auto drop = [&](NcGroup group) {
    consumed |= std::uint64_t{1} << codes_.place[static_cast<std::size_t>(group)];
  };
  drop(NcGroup::non_modal);
  if (codes_[NcGroup::distance] == 910) drop(NcGroup::distance);
  writer_.set_number(block_.number);
  append_words(consumed);
  std::string& words = writer_.words();
  if (!words.empty()) words += ' ';
  words += code;
  pass_comments(false);
  writer_.words_as_line();
  note_what_was_said(false);
}

}  // namespace abbe
