#include "abbe/formats/text/toml_document.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "abbe/formats/text/toml_scan.h"

namespace abbe {
namespace {

/// Adds that TOML is expected if the name ends like that of another format, such as a table of readings.
std::string expected_in(const std::string& file, const std::string& expected) {
  const std::string ending = std::filesystem::path(file).extension().string();
  if (ending.empty() || ending == ".toml") return expected;
  return expected + (expected.empty() ? "" : "; ") + "a TOML file, whose name usually ends in .toml";
}

}  // namespace

TomlDocument::TomlDocument(std::string text, std::string file) : file_(std::move(file)), text_(std::move(text)) {
  if (text_.starts_with("\xEF\xBB\xBF")) text_.erase(0, 3);
  if (text_.find_first_not_of(" \t\r\n") == std::string::npos) throw InputError({file_, 0, 0, ""}, "the file is empty");
  line_starts_.push_back(0);
  for (std::size_t at = text_.find('\n'); at != std::string::npos; at = text_.find('\n', at + 1)) {
    line_starts_.push_back(at + 1);
  }
  try {
    refuse_what_the_parser_cannot_take(text_, file_);
    root_ = toml::parse(text_, file_);
  } catch (const InputError& error) {
    throw InputError(error.place(), error.problem(), expected_in(file_, error.expected()));
  } catch (const toml::parse_error& error) {
    throw InputError(place(error.source().begin, ""), std::string(error.description()), expected_in(file_, ""));
  }
}

InputError::Place TomlDocument::place(const toml::source_position& position, std::string field) const {
  return {file_, position.line, position.column, std::move(field)};
}

std::string TomlDocument::number_text(const toml::source_position& position) const {
  if (position.line == 0 || position.line > line_starts_.size() || position.column == 0) return {};
  std::size_t at = line_starts_[position.line - 1];
  // toml++ counts characters, the text is UTF-8.
  for (std::size_t skipped = 1; skipped < position.column && at < text_.size(); ++skipped) {
    ++at;
    while (at < text_.size() && (static_cast<unsigned char>(text_[at]) & 0xC0U) == 0x80U) ++at;
  }
  const std::size_t end = std::min(text_.find_first_not_of("+-.0123456789_eE", at), text_.size());
  std::string number;
  for (; at < end; ++at) {
    if (text_[at] != '_') number += text_[at];
  }
  return number;
}

}  // namespace abbe
