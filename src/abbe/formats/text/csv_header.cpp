#include "abbe/formats/text/csv_header.h"

#include <fmt/format.h>

#include <algorithm>

#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

constexpr std::size_t kMostListed = 12;

std::string names(const CsvColumn& column) {
  return column.is_text ? column.base : accepted_names(column.base, column.quantity);
}

/// Names and quantities of all wanted columns of a base: a target may be a length or an angle.
std::string names_of_base(const std::string& base, const std::vector<CsvColumn>& wanted) {
  std::string text;
  for (const CsvColumn& column : wanted) {
    if (column.base == base) text += (text.empty() ? "" : ", or ") + names(column);
  }
  return text;
}

std::string quantities_of_base(const std::string& base, const std::vector<CsvColumn>& wanted) {
  std::string text;
  for (const CsvColumn& column : wanted) {
    if (column.base == base) text.append(text.empty() ? "" : " or ").append(quantity_words(column.quantity));
  }
  return text;
}

/// Index of the wanted column of our name, or kUnreadColumn.
std::size_t find_wanted(std::string_view name, const std::vector<CsvColumn>& wanted, const Unit*& unit) {
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    unit = nullptr;
    if (wanted[i].is_text) {
      if (name == wanted[i].base) return i;
      continue;
    }
    unit = unit_of_name(name, wanted[i].base, wanted[i].quantity);
    if (unit != nullptr) return i;
  }
  return kUnreadColumn;
}

/// "one of X, Y, station", without the units.
std::string known_columns(const std::vector<std::string>& known) {
  const std::size_t listed = std::min(known.size(), kMostListed);
  return "one of " +
         fmt::format("{}", fmt::join(known.begin(), known.begin() + static_cast<std::ptrdiff_t>(listed), ", ")) +
         (listed < known.size() ? ", ..." : "");
}

[[noreturn]] void refuse_unknown(const InputError::Place& place, const std::string& name,
                                 const std::vector<CsvColumn>& wanted, const std::string& ignored_by) {
  std::vector<std::string> known;
  const CsvColumn* longest = nullptr;
  for (const CsvColumn& column : wanted) {
    // A base may be wanted as a length or as an angle.
    if (std::find(known.begin(), known.end(), column.base) == known.end()) known.push_back(column.base);
    if (column.is_text || (name != column.base && !name.starts_with(column.base + "_"))) continue;
    if (longest == nullptr || column.base.size() > longest->base.size()) longest = &column;
  }
  if (longest != nullptr && name == longest->base) {
    throw InputError(place, "the unit is missing from the name of this column", names_of_base(longest->base, wanted));
  }
  if (longest != nullptr) {
    throw InputError(place,
                     fmt::format("'{}' is not a unit of {}", name.substr(longest->base.size() + 1),
                                 quantities_of_base(longest->base, wanted)),
                     names_of_base(longest->base, wanted));
  }
  const std::string_view base = without_unit(name);
  const std::string_view near = nearest_name(base, known);
  throw InputError(place,
                   near.empty() ? "unknown column"
                                : fmt::format("unknown column (did you mean {}{}?)", near, name.substr(base.size())),
                   known_columns(known) + (ignored_by.empty() ? "" : "; or its name under " + ignored_by));
}

}  // namespace

std::string_view csv_next_line(std::string_view text, std::size_t& at) {
  const std::size_t end = std::min(text.find('\n', at), text.size());
  std::string_view line = text.substr(at, end - at);
  if (line.ends_with('\r')) line.remove_suffix(1);
  at = std::min(end + 1, text.size());
  return line;
}

std::string_view csv_trimmed(std::string_view field) {
  while (!field.empty() && (field.front() == ' ' || field.front() == '\t')) field.remove_prefix(1);
  while (!field.empty() && (field.back() == ' ' || field.back() == '\t')) field.remove_suffix(1);
  return field;
}

bool csv_is_passed_over(std::string_view line) {
  line = csv_trimmed(line);
  return line.empty() || line.front() == '#';
}

bool csv_take_field(std::string_view& line, std::string_view& field, std::string& unquoted, bool& more) {
  std::size_t start = 0;
  while (start < line.size() && (line[start] == ' ' || line[start] == '\t')) ++start;
  std::size_t end;
  if (start < line.size() && line[start] == '"') {
    unquoted.clear();
    std::size_t at = start + 1;
    for (;; ++at) {
      if (at >= line.size()) return false;
      if (line[at] == '"') {
        if (at + 1 >= line.size() || line[at + 1] != '"') break;
        ++at;
      }
      unquoted += line[at];
    }
    field = unquoted;
    end = std::min(line.find(',', at), line.size());
    if (!csv_trimmed(line.substr(at + 1, end - at - 1)).empty()) return false;
  } else {
    end = std::min(line.find(','), line.size());
    field = csv_trimmed(line.substr(0, end));
  }
  more = end < line.size();
  line.remove_prefix(more ? end + 1 : end);
  return true;
}

CsvNames csv_names(std::string_view text) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  CsvNames found;
  std::string_view header;
  for (std::size_t at = 0; at < text.size() && csv_is_passed_over(header); ++found.line) {
    header = csv_next_line(text, at);
  }
  if (csv_is_passed_over(header)) return {};
  std::string unquoted;
  std::string_view field;
  for (bool more = true; more && csv_take_field(header, field, unquoted, more);) found.names.emplace_back(field);
  return found;
}

std::vector<CsvFileColumn> csv_match_header(std::string_view header, const std::string& file, std::size_t line,
                                            const std::vector<CsvColumn>& wanted, const ColumnMapping& mapping) {
  std::vector<CsvFileColumn> columns;
  std::vector<std::string> found_as(wanted.size());
  const std::size_t length = header.size();
  std::string unquoted;
  std::string_view field, rest = header;
  for (bool more = true; more;) {
    const std::size_t position = length - rest.size() + 1;
    if (!csv_take_field(rest, field, unquoted, more)) {
      throw InputError({file, line, position, ""}, "a quote in the header is not closed before the comma");
    }
    CsvFileColumn column;
    column.name = std::string(field);
    const InputError::Place place{file, line, position, column.name};
    if (field.empty()) throw InputError(place, fmt::format("column {} has no name", columns.size() + 1));
    if (field.find(';') != std::string_view::npos || field.find('\t') != std::string_view::npos) {
      throw InputError(place, "the columns are not separated by commas",
                       "commas between columns and a decimal point (abbe import converts other tables)");
    }
    for (const CsvFileColumn& other : columns) {
      if (other.name == column.name) throw InputError(place, "this column is given twice");
    }
    const auto mapped = std::find_if(mapping.columns.begin(), mapping.columns.end(),
                                     [&](const auto& entry) { return entry.second == column.name; });
    const bool ignored = std::find(mapping.ignore.begin(), mapping.ignore.end(), column.name) != mapping.ignore.end();
    if (!ignored) {
      const std::string& ours = mapped == mapping.columns.end() ? column.name : mapped->first;
      column.wanted = find_wanted(ours, wanted, column.unit);
      if (column.wanted == kUnreadColumn) refuse_unknown(place, ours, wanted, mapping.ignored_by);
      std::string& earlier = found_as[column.wanted];
      if (!earlier.empty()) throw InputError(place, fmt::format("says the same as column {}", earlier));
      earlier = column.name;
    }
    columns.push_back(std::move(column));
  }
  for (const auto& [ours, theirs] : mapping.columns) {
    const auto is_it = [&, name = theirs](const CsvFileColumn& column) { return column.name == name; };
    if (std::none_of(columns.begin(), columns.end(), is_it)) {
      throw InputError({file, line, 0, theirs}, fmt::format("there is no such column to be read as {}", ours));
    }
  }
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    if (!wanted[i].required || !found_as[i].empty()) continue;
    throw InputError({file, line, 0, wanted[i].base}, "missing column", names(wanted[i]));
  }
  return columns;
}

}  // namespace abbe
