#include "abbe/study/imports/imported_instrument.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

/// The form that was asked for, or the one that the contents have.
std::optional<RecognisedFormat> format_of(const ImportRequest& request) {
  if (request.mapping && !request.format.empty()) {
    throw InputError({.field = "--format"}, "is given together with a mapping", "one of them");
  }
  const std::string& wanted = request.mapping ? request.mapping->format : request.format;
  if (wanted == kTableFormat || (request.mapping && wanted.empty())) return std::nullopt;
  if (wanted.empty()) return recognise_instrument(request.text.text);
  const InstrumentFormat* const format = instrument_format_named(wanted);
  if (format == nullptr) {
    throw InputError({.field = "--format"}, fmt::format("there is no form '{}'", wanted),
                     fmt::format("one of {}", fmt::join(import_format_names(), ", ")));
  }
  return RecognisedFormat{format, {request.mapping ? "as the mapping says" : "as given", true}};
}

void refuse_options(const ImportRequest& request, const InstrumentFormat& format) {
  const auto refuse = [&](const char* option, bool is_given) {
    if (!is_given) return;
    throw InputError({.file = request.file, .field = option}, fmt::format("is of no use for a {}", format.words),
                     "no such option, or --format table for a table");
  };
  refuse("--separator", request.hints.layout.separator.has_value());
  refuse("--decimal", request.hints.layout.decimal.has_value());
  refuse("--azimuth", request.hints.clockwise.has_value());
  refuse("--vertical", request.hints.zenith.has_value());
  refuse("--machine", request.machine.has_value());
}

void mirror(const std::string& coordinate, ImportedTable& result) {
  if (coordinate.empty()) return;
  bool found = false;
  for (ProposedColumn& column : result.columns) {
    const std::string& name = column.column.name;
    if (!name.starts_with(coordinate + "_") && name != "n" + coordinate) continue;
    column.column.convention = ImportConvention::reversed;
    column.reason += "; reversed as given: the frame is left-handed";
    found = found || name.starts_with(coordinate + "_");
  }
  if (!found) throw InputError({.field = "--mirrored"}, "the file has no such coordinate", "no such option");
}

void take_proposed_columns(const ImportRequest& request, const InstrumentTable& table, ImportedTable& result) {
  result.columns = proposed_columns(table);
  mirror(request.hints.mirrored, result);
  for (const ProposedColumn& column : result.columns) result.mapping.columns.push_back(column.column);
  result.mapping.kind = table.kind;
  result.mapping.format = result.format;
  if (request.text.given) result.mapping.encoding = request.text.encoding;
}

void take_mapped_columns(const ImportRequest& request, ImportedTable& result) {
  result.mapping = *request.mapping;
  const std::vector<std::string>& names = result.found.names;
  std::vector<bool> is_read(names.size());
  for (const MappedColumn& column : request.mapping->columns) {
    ProposedColumn& taken = result.columns.emplace_back();
    taken.column = column;
    taken.reason = "as the mapping says";
    taken.source = column.from_column > 0
                       ? column.from_column - 1
                       : static_cast<std::size_t>(std::find(names.begin(), names.end(), column.from) - names.begin());
    if (taken.source < is_read.size()) is_read[taken.source] = true;
  }
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (!is_read[k]) result.not_read.push_back(names[k]);
  }
}

}  // namespace

std::optional<InstrumentRows> take_instrument(const ImportRequest& request, ImportedTable& result) {
  const std::optional<RecognisedFormat> found = format_of(request);
  if (!found) return std::nullopt;
  const InstrumentFormat& format = *found->format;
  refuse_options(request, format);
  InstrumentTable table = format.read(request.text.text, request.file, request.hints);
  const std::optional<ImportKind> kind = request.mapping ? request.mapping->kind : request.kind;
  if (kind && *kind != table.kind) {
    throw InputError({.file = request.file, .field = request.mapping ? "kind" : "--as"},
                     fmt::format("a {} does not become {}", format.words, import_kind_name(*kind)),
                     std::string(import_kind_name(table.kind)));
  }
  result.format = format.name;
  result.format_reason = found->recognition.reason;
  result.kind_reason = "what such a file holds";
  result.found.layout.separator = FieldSeparator::comma;
  result.found.reasons = std::move(table.reasons);
  for (const InstrumentColumn& column : table.columns) {
    result.found.names.push_back(column.name);
    result.found.units.push_back(column.unit_is_stated ? column.unit : "");
  }
  result.facts = std::move(table.facts);
  result.not_read = std::move(table.not_read);
  if (request.mapping) {
    take_mapped_columns(request, result);
  } else {
    take_proposed_columns(request, table, result);
    result.found.doubts = std::move(table.doubts);
    if (!found->recognition.certain) {
      result.found.doubts.push_back(
          fmt::format("it looks like a {}, and other programs may write the same (--format {}, or --format table)",
                      format.words, format.name));
    }
  }
  return InstrumentRows{std::move(table.rows), std::move(table.lines)};
}

void refuse_in_file(const ImportRequest& request, const InstrumentRows& rows, const InputError& error,
                    std::size_t first) {
  InputError::Place place = error.place();
  place.file = request.file;
  place.column = 0;
  const std::size_t row = place.line - first;
  place.line = place.line >= first && row < rows.lines.size() ? rows.lines[row] : 0;
  throw InputError(std::move(place), error.problem(), error.expected());
}

}  // namespace abbe
