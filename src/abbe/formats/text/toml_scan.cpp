#include "abbe/formats/text/toml_scan.h"

#include <algorithm>

#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/utf8.h"

namespace abbe {
namespace {

constexpr const char* kName = "a name of letters, digits, _ and -, or a text in quotes";

class Scanner {
 public:
  Scanner(std::string_view text, const std::string& file) : text_(text), file_(file) {}

  void scan() {
    bool line_start = true;
    while (at_ < text_.size()) {
      const char c = text_[at_];
      if (c == '#') {
        at_ = std::min(text_.find('\n', at_), text_.size());
      } else if (c == '"' || c == '\'') {
        check_before_quote();
        skip_string(c);
        line_start = false;
      } else if (c == '[' && line_start && open_.empty()) {
        check_header();
        line_start = false;
      } else {
        step(c);
        line_start = c == '\n' || (line_start && (c == ' ' || c == '\t' || c == '\r'));
        ++at_;
      }
    }
  }

 private:
  /// One character outside texts, comments and the beginning of headers.
  void step(char c) {
    const auto code = static_cast<unsigned char>(c);
    if (code >= 0x7F || (code < 0x20 && c != '\t' && c != '\r' && c != '\n')) {
      fail("a character that may stand in texts and comments only", kName);
    }
    if (in_value_ && c >= '0' && c <= '9' && at_ > 0 &&
        std::string_view(" \t\r\n=[{,").find(text_[at_ - 1]) != std::string_view::npos) {
      check_date();
    }
    if (c == '=') in_value_ = true;
    if (c == '[' || c == '{') {
      // Behind a wrong value the parser reads on over brackets and quotes, and then takes no character beyond ASCII.
      if (in_value_ && at_ > 0 && std::string_view(" \t\r\n=[{,").find(text_[at_ - 1]) == std::string_view::npos) {
        fail("a bracket in the middle of a value", "a comma or a blank before it");
      }
      open_ += c;
      in_value_ = c == '[';
    } else if ((c == ']' || c == '}') && !open_.empty()) {
      if ((open_.back() == '[') != (c == ']')) {
        fail("a bracket that closes another kind", open_.back() == '[' ? "]" : "}");
      }
      open_.pop_back();
      in_value_ = true;
    } else if ((c == '\n' && open_.empty()) || (c == ',' && !open_.empty() && open_.back() == '{')) {
      in_value_ = false;
    }
  }

  /// A text begins a value or a part of a key; anywhere else the parser does not take the quote for the beginning of
  /// one.
  void check_before_quote() const {
    if (!in_value_ && (next_is("\"\"\"") || next_is("\'\'\'"))) fail("a text of several lines as a name", kName);
    const std::string_view allowed = in_value_ ? " \t\r\n=[{," : " \t\r\n[{,.";
    if (at_ > 0 && allowed.find(text_[at_ - 1]) == std::string_view::npos) {
      fail("a quote in the middle of a word", "=, a comma or a blank before it");
    }
  }

  /// What the parser takes for the beginning of a date; it does not count underscores.
  void check_date() const {
    std::string word;
    for (std::size_t i = at_; i < text_.size() && word.size() < 8; ++i) {
      if (std::string_view(" \t\r\n,]}#").find(text_[i]) != std::string_view::npos) break;
      if (text_[i] != '_') word += text_[i];
    }
    if (word.size() == 8 && word[4] == '-' && word[7] == '-') fail("a date", "a number, or a text in quotes");
  }

  [[noreturn]] void fail(const std::string& problem, const std::string& expected) const {
    const std::string_view before = text_.substr(0, at_);
    const std::size_t line_end = before.rfind('\n');
    const std::string_view line = line_end == std::string_view::npos ? before : before.substr(line_end + 1);
    throw InputError({file_, 1 + static_cast<std::size_t>(std::count(before.begin(), before.end(), '\n')),
                      1 + characters_in(line), ""},
                     problem, expected);
  }

  bool next_is(std::string_view what) const { return text_.substr(at_).starts_with(what); }

  void skip_string(char quote) {
    const std::string three(3, quote);
    if (next_is(three)) {
      at_ += 3;
      while (at_ < text_.size() && !next_is(three)) skip_character(quote);
      // Up to two quotes before the closing ones belong to the text.
      while (at_ < text_.size() && text_[at_] == quote) ++at_;
      return;
    }
    ++at_;
    while (at_ < text_.size() && text_[at_] != quote && text_[at_] != '\n') skip_character(quote);
    if (at_ < text_.size() && text_[at_] == quote) ++at_;
  }

  void skip_character(char quote) {
    const bool escaped = quote == '"' && text_[at_] == '\\' && at_ + 1 < text_.size() && text_[at_ + 1] != '\n';
    if (escaped && static_cast<unsigned char>(text_[at_ + 1]) >= 0x7F) {
      fail("a backslash before a character that needs none", "\\\\ for a backslash");
    }
    at_ += escaped ? 2 : 1;
  }

  void check_header() {
    ++at_;
    if (at_ < text_.size() && text_[at_] == '[') ++at_;
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t')) ++at_;
    if (at_ == text_.size()) return;
    const char c = text_[at_];
    const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    if (!letter && std::string_view("_-\"']").find(c) == std::string_view::npos) {
      fail("a table header without a name", kName);
    }
  }

  std::string_view text_;
  const std::string& file_;
  std::size_t at_ = 0;
  std::string open_;       // brackets and braces of values that are not closed yet
  bool in_value_ = false;  // behind =, not in a key
};

}  // namespace

void refuse_what_the_parser_cannot_take(std::string_view text, const std::string& file) { Scanner(text, file).scan(); }

}  // namespace abbe
