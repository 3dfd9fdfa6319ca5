#include "abbe/formats/import/column_source.h"

#include <fmt/format.h>

#include <algorithm>

#include "abbe/formats/import/foreign_row.h"
#include "abbe/formats/import/foreign_word.h"
#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

class SourceFinder {
 public:
  SourceFinder(const std::string& file, const FoundLayout& found, const ImportMapping& mapping,
               const std::vector<ImportColumn>& wanted)
      : file_(file), found_(found), mapping_(mapping), wanted_(wanted) {}

  std::vector<ColumnSource> find() {
    std::vector<ColumnSource> sources;
    for (at_ = 0; at_ < mapping_.columns.size(); ++at_) {
      const MappedColumn& column = mapping_.columns[at_];
      const ImportColumn& wanted = wanted_of(column);
      ColumnSource source;
      source.source = index_of(column);
      source.name = found_.names[source.source].empty() ? fmt::format("column {}", source.source + 1)
                                                        : found_.names[source.source];
      source.holds = wanted.holds;
      source.unit = column.unit.empty() ? nullptr : foreign_unit_named(column.unit);
      source.convention = column.convention;
      source.positive = column.positive;
      source.negative = column.negative;
      check_convention(column, wanted);
      check_stated_unit(source);
      sources.push_back(std::move(source));
    }
    for (const ImportColumn& wanted : wanted_) {
      if (!wanted.required || std::any_of(mapping_.columns.begin(), mapping_.columns.end(),
                                          [&](const MappedColumn& c) { return is_named(c, wanted); })) {
        continue;
      }
      throw InputError({.file = mapping_.file, .field = "column"},
                       fmt::format("no column is written as {}", wanted.base),
                       fmt::format("all that a table of the kind {} needs", import_kind_name(mapping_.kind)));
    }
    return sources;
  }

 private:
  static bool is_named(const MappedColumn& column, const ImportColumn& wanted) {
    const bool has_unit = wanted.holds == ImportColumn::Holds::number && wanted.quantity != Quantity::dimensionless;
    if (!has_unit) return column.name == wanted.base;
    return unit_of_name(column.name, wanted.base, wanted.quantity) != nullptr;
  }

  [[noreturn]] void fail(const char* key, const std::string& problem, const std::string& expected) const {
    throw InputError({.file = mapping_.file, .field = fmt::format("column[{}].{}", at_ + 1, key)}, problem, expected);
  }

  const ImportColumn& wanted_of(const MappedColumn& column) const {
    const auto found = std::find_if(wanted_.begin(), wanted_.end(),
                                    [&](const ImportColumn& wanted) { return is_named(column, wanted); });
    if (found == wanted_.end()) {
      std::vector<std::string> bases;
      for (const ImportColumn& wanted : wanted_) bases.push_back(wanted.base);
      fail("name",
           fmt::format("'{}' is no column of a table of the kind {}", column.name.substr(0, 60),
                       import_kind_name(mapping_.kind)),
           fmt::format("one of {} with its unit", fmt::join(bases, ", ")));
    }
    const bool has_unit = found->holds == ImportColumn::Holds::number && found->quantity != Quantity::dimensionless;
    const ForeignUnit* const unit = foreign_unit_named(column.unit);
    if (!has_unit) {
      if (!column.unit.empty()) fail("unit", "this column has no unit", "no unit");
    } else if (unit == nullptr || unit->quantity != found->quantity) {
      fail("unit", unit == nullptr ? "is missing" : fmt::format("is not one of {}", quantity_words(found->quantity)),
           fmt::format("one of {}", fmt::join(foreign_unit_names(found->quantity), ", ")));
    } else if (column.name != import_header(*found, unit->suffix)) {
      fail("name", fmt::format("numbers in {} are written in {}", unit->name, unit->suffix),
           import_header(*found, unit->suffix));
    }
    const bool direction = holds_direction(*found);
    if (!direction && !(column.positive.empty() && column.negative.empty())) {
      fail(column.positive.empty() ? "negative" : "positive", "this column has no directions", "no such key");
    }
    return *found;
  }

  std::size_t index_of(const MappedColumn& column) const {
    const std::vector<std::string>& names = found_.names;
    if (column.from_column > 0) {
      if (column.from_column <= names.size()) return column.from_column - 1;
      throw InputError(
          {.file = file_, .line = found_.layout.first_line},
          fmt::format("there are {} columns, and {} is to be column {}", names.size(), column.name, column.from_column),
          "the columns that the mapping describes");
    }
    const auto at = std::find(names.begin(), names.end(), column.from);
    const auto count = std::count(names.begin(), names.end(), column.from);
    if (count == 1) return static_cast<std::size_t>(at - names.begin());
    throw InputError({.file = file_, .line = found_.layout.header_line, .field = column.from},
                     count == 0 ? "there is no column of this name" : "more than one column has this name",
                     fmt::format("a column to be read as {}", column.name));
  }

  void check_convention(const MappedColumn& column, const ImportColumn& wanted) const {
    const auto need = [&](bool is_right, const char* expected) {
      if (!is_right) {
        fail("convention", fmt::format("'{}' does not belong to {}", convention_name(column.convention), wanted.base),
             expected);
      }
    };
    switch (column.convention) {
      case ImportConvention::as_written:
        return;
      case ImportConvention::reversed:
        return need(wanted.base == "deviation" || is_coordinate(wanted), "a coordinate or a deviation");
      case ImportConvention::zenith:
        return need(wanted.base == "elevation", "elevation");
      case ImportConvention::clockwise:
        return need(wanted.base == "azimuth", "azimuth");
    }
  }

  /// Coordinates of points, of normals, and of offsets.
  static bool is_coordinate(const ImportColumn& wanted) {
    const char letter = wanted.base.back();
    return wanted.holds == ImportColumn::Holds::number && letter >= 'x' && letter <= 'z' &&
           wanted.quantity != Quantity::angle;
  }

  /// A file that says millimetres is not read in inches.
  void check_stated_unit(const ColumnSource& source) const {
    if (source.unit == nullptr || source.unit->sexagesimal) return;
    const std::string row(without_brackets(found_.units[source.source]));
    const std::string stated = row.empty() ? split_header(found_.names[source.source]).second : row;
    if (stated.empty() || small_letters(stated) == "grad") return;
    const ForeignUnit* const unit = foreign_unit(stated, source.unit->quantity);
    if (unit == source.unit) return;
    if (unit == nullptr && !is_foreign_unit(stated)) return;
    const std::size_t line = row.empty() ? found_.layout.header_line : found_.layout.unit_line;
    throw InputError({.file = file_, .line = line, .field = source.name},
                     fmt::format("the file says {}, and the mapping {}", stated, source.unit->name), "the same unit");
  }

  const std::string& file_;
  const FoundLayout& found_;
  const ImportMapping& mapping_;
  const std::vector<ImportColumn>& wanted_;
  std::size_t at_ = 0;
};

}  // namespace

std::vector<ColumnSource> column_sources(const std::string& file, const FoundLayout& found,
                                         const ImportMapping& mapping, const std::vector<ImportColumn>& wanted) {
  return SourceFinder(file, found, mapping, wanted).find();
}

}  // namespace abbe
