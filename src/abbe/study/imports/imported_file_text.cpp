#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/list_text.h"
#include "abbe/formats/text/utf8.h"
#include "abbe/study/imports/imported_file.h"

namespace abbe {
namespace {

std::string source_words(const ImportedTable& result, const ProposedColumn& column) {
  const std::string& name = result.found.names[column.source];
  std::string words = result.format == kTableFormat ? column_words(column.source, name)
                                                    : fmt::format("'{}'", printable(name, 40, LineFeeds::escaped));
  if (!column.column.unit.empty()) words += fmt::format(", {}", column.column.unit);
  if (column.column.convention != ImportConvention::as_written) {
    words += fmt::format(", {}", convention_name(column.column.convention));
  }
  return words;
}

/// Parts separated by "; " behind the first words, in lines of at most 120 columns where their lengths allow it.
std::string lines_of_parts(const std::string& first, std::string_view parts, std::size_t indent) {
  constexpr std::size_t kColumns = 120;
  std::string text, line = first;
  bool has_part = false;
  while (!parts.empty()) {
    const std::size_t end = std::min(parts.find("; "), parts.size());
    const std::string_view part = parts.substr(0, end);
    parts.remove_prefix(std::min(end + 2, parts.size()));
    if (has_part) line += ';';
    if (has_part && characters_in(line) + characters_in(part) + 2 > kColumns) {
      text += line + '\n';
      line = std::string(indent - 1, ' ');
    }
    line += fmt::format(" {}", part);
    has_part = true;
  }
  return text + line + '\n';
}

nlohmann::ordered_json layout_json(const TableLayout& layout) {
  nlohmann::ordered_json json = {{"separator", separator_name(layout.separator)},
                                 {"decimal", decimal_name(layout.decimal)},
                                 {"thousands", thousands_name(layout.thousands)},
                                 {"comment", layout.comment}};
  json["header_line"] = layout.header_line;
  json["unit_line"] = layout.unit_line;
  json["first_line"] = layout.first_line;
  return json;
}

}  // namespace

std::string imported_mapping_text(const ImportedTable& result) {
  if (!result.has_readings()) {
    throw InputError({.file = result.file}, "there are no readings, so there is no mapping", "no --write-mapping");
  }
  std::vector<std::vector<std::string>> remarks;
  for (const ProposedColumn& column : result.columns) {
    std::vector<std::string>& lines = remarks.emplace_back();
    if (!column.reason.empty()) lines.push_back(column.reason);
    for (const std::string& doubt : column.doubts) {
      lines.push_back((result.doubts_accepted ? "accepted: " : "UNCERTAIN: ") + doubt);
    }
  }
  std::string text = "# How abbe import reads tables like ";
  text += printable(result.file, 200, LineFeeds::escaped) + ": abbe import FILE --mapping THIS_FILE\n";
  for (const std::string& doubt : result.found.doubts) text += "# UNCERTAIN: " + doubt + "\n";
  return text + import_mapping_text(result.mapping, remarks);
}

std::string imported_table_text(const ImportedTable& result) {
  std::string text = fmt::format("{}: {}{} ({})\n", result.file, result.packed ? "gzip, " : "",
                                 encoding_name(result.encoding), result.encoding_reason);
  if (const InstrumentFormat* const format = instrument_format_named(result.format)) {
    text += fmt::format("  {}: {}\n", format->words, result.format_reason);
  }
  for (const std::string& reason : result.found.reasons) text += fmt::format("  {}\n", reason);
  text += result.has_readings()
              ? fmt::format("\nread as {} ({}):\n", import_kind_name(result.mapping.kind), result.kind_reason)
              : "\nno readings\n";
  std::size_t width = 0;
  for (const ProposedColumn& column : result.columns) width = std::max(width, column.column.name.size());
  for (const ProposedColumn& column : result.columns) {
    text += lines_of_parts(fmt::format("  {:<{}}  {}:", column.column.name, width, source_words(result, column)),
                           column.reason, width + 6);
    for (const std::string& doubt : column.doubts) {
      text += lines_of_parts(fmt::format("  {:<{}}  {}:", "", width, result.doubts_accepted ? "accepted" : "UNCERTAIN"),
                             doubt, width + 6);
    }
  }
  for (const InstrumentFact& fact : result.facts) {
    text += fmt::format("stated: {}: {}\n", printable(fact.name, 60, LineFeeds::escaped),
                        printable(fact.value, 100, LineFeeds::escaped));
  }
  if (!result.not_read.empty()) text += fmt::format("not read: {}\n", fmt::join(result.not_read, ", "));
  for (const std::string& doubt : result.found.doubts) {
    text += fmt::format("{}: {}\n", result.doubts_accepted ? "accepted" : "UNCERTAIN", doubt);
  }
  if (!result.has_readings()) return text;
  const ImportedRows& rows = result.rows;
  text += "\n" + counted(rows.rows, "row", "rows");
  if (rows.blank_lines > 0) text += "; passed over: " + counted(rows.blank_lines, "blank line", "blank lines");
  if (rows.comment_lines > 0) {
    text += fmt::format("{}{}", rows.blank_lines > 0 ? ", " : "; passed over: ",
                        counted(rows.comment_lines, "comment line", "comment lines"));
  }
  return text + "\n";
}

std::string_view what_to_do_next(const ImportedTable& result) {
  return result.has_readings()
             ? "what is uncertain has to be confirmed: by options, --accept-uncertain, or a mapping file"
             : "there are no readings";
}

nlohmann::ordered_json imported_table_json(const ImportedTable& result) {
  nlohmann::ordered_json json = {{"file", result.file},
                                 {"kind", import_kind_name(result.mapping.kind)},
                                 {"kind_reason", result.kind_reason},
                                 {"encoding", encoding_name(result.encoding)},
                                 {"encoding_reason", result.encoding_reason},
                                 {"gzip", result.packed}};
  json["format"] = result.format;
  json["format_reason"] = result.format_reason;
  json["layout"] = result.format == kTableFormat ? layout_json(result.found.layout) : nlohmann::ordered_json();
  json["layout_reasons"] = result.found.reasons;
  json["layout_doubts"] = result.found.doubts;
  json["columns"] = nlohmann::ordered_json::array();
  for (const ProposedColumn& column : result.columns) {
    nlohmann::ordered_json one = {{"name", column.column.name}};
    one["column"] = column.source + 1;
    one["from"] = result.found.names[column.source];
    one["unit"] = column.column.unit;
    one["convention"] = convention_name(column.column.convention);
    if (!column.column.positive.empty()) one["positive"] = column.column.positive;
    if (!column.column.negative.empty()) one["negative"] = column.column.negative;
    one["reason"] = column.reason;
    one["doubts"] = column.doubts;
    json["columns"].push_back(std::move(one));
  }
  json["facts"] = nlohmann::ordered_json::array();
  for (const InstrumentFact& fact : result.facts) {
    json["facts"].push_back({{"name", fact.name}, {"value", fact.value}});
  }
  json["not_read"] = result.not_read;
  json["certain"] = result.is_certain();
  json["rows"] = result.rows.rows;
  json["blank_lines"] = result.rows.blank_lines;
  json["comment_lines"] = result.rows.comment_lines;
  return json;
}

}  // namespace abbe
