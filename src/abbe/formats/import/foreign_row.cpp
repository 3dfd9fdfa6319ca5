#include "abbe/formats/import/foreign_row.h"

#include <cstring>

#include "abbe/formats/text/csv_header.h"
#include "abbe/formats/text/line_numbers.h"

namespace abbe {
namespace {

char separator_character(FieldSeparator separator) {
  switch (separator) {
    case FieldSeparator::comma:
      return ',';
    case FieldSeparator::semicolon:
      return ';';
    case FieldSeparator::tab:
      return '\t';
    case FieldSeparator::blanks:
      break;
  }
  return ' ';
}

}  // namespace

const char* ForeignRow::take_quoted(const char* at, const char* end) {
  const std::size_t begin = unquoted_.size();
  for (++at;; ++at) {
    if (at == end) return nullptr;
    if (*at == '"') {
      if (at + 1 == end || at[1] != '"') break;
      ++at;
    }
    unquoted_ += *at;
  }
  fields_.back().text = csv_trimmed(std::string_view(unquoted_).substr(begin));
  return at + 1;
}

bool ForeignRow::split(std::string_view line, FieldSeparator separator) {
  fields_.clear();
  unquoted_.clear();
  unquoted_.reserve(line.size());  // so that fields in it stay where they are
  const char* at = line.data();
  const char* const end = at + line.size();
  const char mark = separator_character(separator);
  const bool blanks = separator == FieldSeparator::blanks;
  for (;;) {
    while (at != end && (*at == ' ' || (*at == '\t' && mark != '\t') || (*at == '\r' && blanks))) ++at;
    if (blanks && at == end) return true;
    const char* const start = at;
    fields_.push_back({{}, static_cast<std::size_t>(start - line.data())});
    if (at != end && *at == '"') {
      at = take_quoted(at, end);
      if (at == nullptr) return false;
      if (blanks) {
        if (at != end && *at != ' ' && *at != '\t' && *at != '\r') return false;
        continue;
      }
      while (at != end && (*at == ' ' || (*at == '\t' && mark != '\t'))) ++at;
      if (at != end && *at != mark) return false;
    } else if (blanks) {
      at = word_end(at, end);
      fields_.back().text = {start, static_cast<std::size_t>(at - start)};
      continue;
    } else {
      const void* const found = at == end ? nullptr : std::memchr(at, mark, static_cast<std::size_t>(end - at));
      at = found == nullptr ? end : static_cast<const char*>(found);
      fields_.back().text = csv_trimmed({start, static_cast<std::size_t>(at - start)});
    }
    if (at == end) return true;
    ++at;
  }
}

void ForeignRow::drop_empty_behind(std::size_t columns) {
  while (fields_.size() > columns && fields_.back().text.empty()) fields_.pop_back();
}

ForeignLine kind_of_line(std::string_view line, const TableLayout& layout) {
  const std::size_t first = line.find_first_not_of(" \t");
  if (first == std::string_view::npos) return ForeignLine::blank;
  if (!layout.comment.empty() && line.substr(first).starts_with(layout.comment)) return ForeignLine::comment;
  const char mark = separator_character(layout.separator);
  if (line[first] != mark) return ForeignLine::row;
  const char only[] = {' ', '\t', mark, '\0'};
  return line.find_first_not_of(only) == std::string_view::npos ? ForeignLine::blank : ForeignLine::row;
}

std::size_t line_start(std::string_view text, std::size_t line) {
  std::size_t at = 0;
  while (--line > 0 && at < text.size()) csv_next_line(text, at);
  return at;
}

std::string_view without_comment_mark(std::string_view line, std::string_view comment) {
  const std::string_view trimmed = csv_trimmed(line);
  return !comment.empty() && trimmed.starts_with(comment) ? trimmed.substr(comment.size()) : line;
}

}  // namespace abbe
