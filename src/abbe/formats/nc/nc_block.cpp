#include "abbe/formats/nc/nc_block.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "abbe/formats/text/ascii_letters.h"
#include "abbe/formats/text/number_text.h"

namespace abbe {
namespace {

constexpr std::array<std::pair<std::string_view, NcFlowWord>, 16> kFlowWords = {{
    {"sub", NcFlowWord::sub},
    {"endsub", NcFlowWord::endsub},
    {"call", NcFlowWord::call},
    {"return", NcFlowWord::return_to_caller},
    {"while", NcFlowWord::while_loop},
    {"endwhile", NcFlowWord::endwhile},
    {"do", NcFlowWord::do_loop},
    {"if", NcFlowWord::if_block},
    {"elseif", NcFlowWord::elseif},
    {"else", NcFlowWord::else_block},
    {"endif", NcFlowWord::endif},
    {"repeat", NcFlowWord::repeat},
    {"endrepeat", NcFlowWord::endrepeat},
    {"break", NcFlowWord::break_loop},
    {"continue", NcFlowWord::continue_loop},
    {"", NcFlowWord::label},
}};

/// The comment that begins at the cursor, with its parentheses or its semicolon.
std::string_view read_comment(NcCursor& cursor) {
  const char* const begin = cursor.at;
  if (*begin == ';') {
    cursor.at = cursor.end;
    const char* last = cursor.end;
    while (last != begin && (last[-1] == '\r' || last[-1] == ' ')) --last;
    return {begin, static_cast<std::size_t>(last - begin)};
  }
  const char* const close = std::find(begin, cursor.end, ')');
  if (close == cursor.end) cursor.fail(begin, "the comment does not end", "a closing parenthesis in the same line");
  if (std::find(begin + 1, close, '(') != close) cursor.fail(begin, "a comment inside a comment");
  cursor.at = close + 1;
  return {begin, static_cast<std::size_t>(close + 1 - begin)};
}

}  // namespace

void NcBlock::fail(const NcWord& word, const std::string& problem, const std::string& expected) const {
  NcCursor place = cursor;
  place.at = word.end;
  place.fail(word.begin, problem, expected);
}

void NcBlock::fail_at_begin(const std::string& problem, const std::string& expected) const {
  NcCursor place = cursor;
  place.at = place.begin;
  place.skip_blanks();
  const char* const first = place.at;
  place.fail(first, problem, expected);
}

void NcBlockReader::begin(NcBlock& block) {
  block.is_deleted = block.is_percent = block.is_computed = false;
  block.number = {};
  block.word_count = 0;
  block.index.fill(NcBlock::kNoWord);
  block.comments.clear();
  block.assignments.clear();
  block.flow = NcFlowWord::none;
  NcCursor& cursor = block.cursor;
  char c = cursor.peek();
  if (c == '%') {
    block.is_percent = true;
    cursor.at = cursor.end;
    return;
  }
  if (c == '/') {
    block.is_deleted = true;
    ++cursor.at;
    c = cursor.peek();
  }
  if (c == 'n') read_line_number(block);
}

void NcBlockReader::read_line_number(NcBlock& block) {
  NcCursor& cursor = block.cursor;
  const char* const first = cursor.at++;
  cursor.skip_blanks();
  const char* const digits = cursor.at;
  while (cursor.at != cursor.end && ((*cursor.at >= '0' && *cursor.at <= '9') || *cursor.at == '.')) ++cursor.at;
  if (cursor.at == digits || cursor.at - digits > 20) cursor.fail(first, "is not a line number", "N and a number");
  block.number = {first, static_cast<std::size_t>(cursor.at - first)};
}

void NcBlockReader::read(std::string_view line, std::size_t number, NcBlock& block) {
  NcCursor& cursor = block.cursor;
  cursor = {line.data(), line.data(), line.data() + line.size(), number, &file_};
  begin(block);
  expression_.was_computed();
  for (bool first = true;; first = false) {
    const char c = cursor.peek();
    if (c == 0) break;
    if (c >= 'a' && c <= 'z') {
      if (c == 'o') {
        if (!first) cursor.fail(cursor.at, "an O word stands first in its block");
        read_flow_word(block);
        return;
      }
      read_word(block, c);
    } else if (c == '(' || c == ';') {
      block.comments.push_back(read_comment(cursor));
    } else if (c == '#') {
      read_assignment(block);
    } else {
      const char* const place = cursor.at++;
      cursor.fail(place, c == '@' || c == '^' ? "polar coordinates are not handled" : "is not a word",
                  "a letter and its value, a parameter that is set, or a comment");
    }
  }
  block.is_computed = expression_.was_computed() || !block.assignments.empty();
}

bool NcBlockReader::read_flow(std::string_view line, std::size_t number, NcBlock& block) const {
  block.cursor = {line.data(), line.data(), line.data() + line.size(), number, &file_};
  const char c = block.cursor.peek();
  if (c != 'o' && c != 'n' && c != '/') return false;
  begin(block);
  if (block.cursor.peek() != 'o') return false;
  read_flow_word(block);
  return true;
}

void NcBlockReader::refuse_statement(NcCursor& cursor) {
  const char* const begin = cursor.at;
  std::string name;
  const char* at = begin;
  for (; at != cursor.end && is_letter(*at) && name.size() < 20; ++at) name += lower_case(*at);
  if (name.size() < 2 || NcExpression::is_function(std::string_view(name).substr(1))) return;
  if (name.size() == 2 && name != "if" && name != "do") return;
  // In front of [ ] it may be meant for a function.
  const char* next = at;
  while (next != cursor.end && *next == ' ') ++next;
  if (next != cursor.end && *next == '[' && name != "if" && name != "while") return;
  cursor.at = at;
  cursor.fail(begin, "is a statement of another language, or not a word",
              "a letter and its value; loops, branches and calls by O words");
}

void NcBlockReader::read_word(NcBlock& block, char letter) {
  NcCursor& cursor = block.cursor;
  const char* const begin = cursor.at;
  if (begin + 1 != cursor.end && is_letter(begin[1])) refuse_statement(cursor);
  ++cursor.at;
  if (letter == 'n') cursor.fail(begin, "a line number stands first in its block");
  if (block.word_count == NcBlock::kMostWords) cursor.fail(begin, "more than 64 words in one block");
  NcWord& word = block.words[block.word_count];
  word.letter = letter;
  word.begin = begin;
  word.value = expression_.read_value(cursor);
  word.end = cursor.at;
  if (!(std::abs(word.value) <= kLargestInput)) cursor.fail(begin, "is too large", "a magnitude of at most 1e9");
  std::uint8_t& index = block.index[static_cast<std::size_t>(letter - 'a')];
  if (index == NcBlock::kNoWord) {
    index = static_cast<std::uint8_t>(block.word_count);
  } else if (letter != 'g' && letter != 'm') {
    cursor.fail(begin, "this letter is in the block already");
  }
  ++block.word_count;
}

void NcBlockReader::read_assignment(NcBlock& block) {
  NcCursor& cursor = block.cursor;
  const char* const begin = cursor.at++;
  NcAssignment assignment;
  if (cursor.peek() == '<') {
    assignment.name = NcExpression::read_name(cursor);
  } else {
    assignment.number = expression_.read_parameter_number(cursor);
    if (NcParameters::is_of_control(assignment.number) || NcParameters::is_of_system(assignment.number)) {
      cursor.fail(begin, "this parameter belongs to the control",
                  "G10, G52, G92 or G28.1 for offsets; #1 to #5000 here");
    }
  }
  if (cursor.peek() != '=') cursor.fail(begin, "a parameter stands here without a letter", "=, or a letter before it");
  ++cursor.at;
  assignment.value = expression_.read_value(cursor);
  block.assignments.push_back(std::move(assignment));
}

void NcBlockReader::read_flow_word(NcBlock& block) {
  NcCursor& cursor = block.cursor;
  block.o_word = cursor.at++;
  if (cursor.peek() == '<') {
    block.label = NcExpression::read_name(cursor);
  } else {
    block.label.clear();
    cursor.skip_blanks();
    while (cursor.at != cursor.end && *cursor.at >= '0' && *cursor.at <= '9' && block.label.size() < 20) {
      block.label += *cursor.at++;
    }
    if (block.label.empty()) {
      cursor.fail(block.o_word, "is not the name of a subroutine or loop", "O100 or O<name>");
    }
    block.label.erase(0, std::min(block.label.find_first_not_of('0'), block.label.size() - 1));
  }
  cursor.skip_blanks();
  const char* const word = cursor.at;
  std::string name;
  for (char c = cursor.peek(); c >= 'a' && c <= 'z' && name.size() < 20; c = cursor.peek()) {
    name += c;
    ++cursor.at;
  }
  const auto* found =
      std::find_if(kFlowWords.begin(), kFlowWords.end(), [&](const auto& f) { return f.first == name; });
  if (found == kFlowWords.end()) {
    cursor.fail(word, "is not what an O word can say",
                "sub, endsub, call, return, if, elseif, else, endif, while, endwhile, do, repeat, endrepeat, break or "
                "continue");
  }
  block.flow = found->second;
}

}  // namespace abbe
