#include "abbe/formats/import/proposed_mapping.h"

#include <fmt/format.h>

#include <algorithm>

#include "abbe/formats/import/column_match.h"
#include "abbe/formats/import/column_proposal.h"
#include "abbe/formats/import/deviation_sign.h"
#include "abbe/formats/import/foreign_row.h"
#include "abbe/formats/import/foreign_word.h"
#include "abbe/formats/import/table_facts.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/list_text.h"
#include "abbe/formats/text/utf8.h"

namespace abbe {
namespace {

/// A kind and what was found for it.
struct KindMatch {
  ImportKind kind = ImportKind::points;
  std::vector<ImportColumn> wanted;
  ColumnMatch match;
};

class Proposer {
 public:
  Proposer(std::string_view text, const std::string& file, const FoundLayout& found, const Machine* machine,
           const ImportHints& hints)
      : text_(text), file_(file), found_(found), machine_(machine), hints_(hints), facts_(column_facts(text, found)) {}

  ProposedMapping proposed(std::optional<ImportKind> kind) const {
    ProposedMapping result;
    const KindMatch chosen = kind ? match(*kind) : only_complete();
    if (!chosen.match.is_complete()) refuse_missing(chosen);
    result.kind = chosen.kind;
    result.reason = kind ? "as given" : "all columns that it needs are there";
    for (std::size_t i = 0; i < chosen.wanted.size(); ++i) {
      if (chosen.match.source[i] != kNoSource) result.columns.push_back(column(chosen, i));
    }
    doubt_handedness(result);
    if (chosen.match.actual != kNoSource) decide_deviation_sign(chosen.match.actual, result);
    for (std::size_t k = 0; k < facts_.size(); ++k) {
      const auto reads = [&](const ProposedColumn& column) { return column.source == k; };
      if (std::any_of(result.columns.begin(), result.columns.end(), reads)) continue;
      if (found_.names[k].empty() && facts_[k].numbers + facts_[k].sexagesimal + facts_[k].texts == 0) continue;
      result.not_read.push_back(column_words(k, found_.names[k]));
    }
    return result;
  }

 private:
  bool has_header() const { return found_.layout.header_line > 0; }

  KindMatch match(ImportKind kind) const {
    if (kind == ImportKind::tracker && machine_ == nullptr) {
      throw InputError({.field = "--machine"}, "is missing", "the machine whose commands the table has");
    }
    KindMatch result;
    result.kind = kind;
    result.wanted = import_columns(kind, machine_ == nullptr ? Machine() : *machine_);
    const PolarOrder* const polar = hints_.polar && kind == ImportKind::tracker ? &*hints_.polar : nullptr;
    result.match =
        has_header() ? match_by_names(kind, result.wanted, facts_) : match_by_order(kind, result.wanted, facts_, polar);
    return result;
  }

  /// With a machine the table is a tracker's; otherwise the kind whose columns are all there.
  KindMatch only_complete() const {
    if (machine_ != nullptr) return match(ImportKind::tracker);
    std::vector<KindMatch> complete;
    for (const ImportKind kind : {ImportKind::points, ImportKind::positioning, ImportKind::circular}) {
      KindMatch one = match(kind);
      if (has_header() && one.match.is_complete()) complete.push_back(std::move(one));
    }
    if (complete.size() == 1) return std::move(complete.front());
    throw InputError({.file = file_, .line = found_.layout.header_line},
                     complete.empty()
                         ? "the columns do not tell what the table is: " + header_words()
                         : fmt::format("the table has the columns of {} and of {}", import_kind_name(complete[0].kind),
                                       import_kind_name(complete[1].kind)),
                     "--as points, --as positioning, --as circular, or --as tracker with --machine");
  }

  std::string header_words() const {
    if (!has_header()) return fmt::format("{} without names", counted(facts_.size(), "column", "columns"));
    std::vector<std::string> names;
    for (const std::string& name : found_.names) names.push_back("'" + printable(name, 40, LineFeeds::escaped) + "'");
    return fmt::format("{}", fmt::join(names, ", "));
  }

  /// What columns without names have to be.
  static std::vector<std::string> needed_numbers(const KindMatch& chosen) {
    std::vector<std::string> bases;
    for (const ImportColumn& column : chosen.wanted) {
      if (is_taken_by_order(column)) bases.push_back(column.base);
    }
    return bases;
  }

  /// Says so where a column is not found because of its unit. Polar coordinates stand for measured_x, actual positions
  /// for deviations.
  void refuse_wrong_unit(const KindMatch& chosen, const std::string& missing) const {
    for (const ImportColumn& wanted : chosen.wanted) {
      const bool stands_for_it =
          (missing == "measured_x" && wanted.group == "polar") || (missing == "deviation" && wanted.base == "actual");
      if (wanted.base != missing && !stands_for_it) continue;
      const std::optional<WrongUnit> wrong = wrong_unit(wanted, facts_);
      if (!wrong) continue;
      const bool in_row = !found_.units[wrong->source].empty();
      throw InputError(
          {.file = file_,
           .line = in_row ? found_.layout.unit_line : found_.layout.header_line,
           .field = column_words(wrong->source, found_.names[wrong->source])},
          fmt::format("'{}' is not a unit of {}", printable(wrong->unit, 40, LineFeeds::escaped),
                      quantity_words(wanted.quantity)),
          fmt::format("one of {} for {}", fmt::join(foreign_unit_names(wanted.quantity), ", "), wanted.base));
    }
  }

  [[noreturn]] void refuse_missing(const KindMatch& chosen) const {
    const std::string& base = chosen.match.missing.front();
    if (has_header()) refuse_wrong_unit(chosen, base);
    const auto wanted = std::find_if(chosen.wanted.begin(), chosen.wanted.end(),
                                     [&](const ImportColumn& column) { return column.base == base; });
    std::string expected = "a header";
    if (has_header()) {
      const auto shown = static_cast<std::ptrdiff_t>(std::min<std::size_t>(wanted->words.size(), 4));
      expected =
          fmt::format("a name such as {}", fmt::join(wanted->words.begin(), wanted->words.begin() + shown, ", "));
    } else if (chosen.kind == ImportKind::points || chosen.kind == ImportKind::tracker) {
      expected = fmt::format("columns of numbers for {}, in their order", fmt::join(needed_numbers(chosen), ", "));
    }
    throw InputError({.file = file_, .line = found_.layout.header_line, .field = base},
                     fmt::format("no column for it was found in {}", header_words()),
                     expected + ", or a mapping file that says which column it is (--mapping)");
  }

  ProposedColumn column(const KindMatch& chosen, std::size_t wanted) const {
    ColumnCase asked;
    asked.wanted = &chosen.wanted[wanted];
    asked.source = chosen.match.source[wanted];
    asked.file = &facts_[asked.source];
    asked.own_name = chosen.match.own_name[wanted];
    asked.unit_in_header = found_.units[asked.source].empty();
    asked.doubt = chosen.match.doubts[wanted];
    if (machine_ != nullptr && chosen.kind == ImportKind::tracker) {
      const std::size_t axis = machine_->find_axis(asked.wanted->base);
      if (axis != Machine::npos) asked.axis = &machine_->axes[axis];
    }
    ProposedColumn proposed = proposed_column(asked, hints_);
    const std::string& name = found_.names[asked.source];
    const bool is_unique = std::count(found_.names.begin(), found_.names.end(), name) == 1;
    if (name.empty() || !is_unique || has_control_character(name)) {
      proposed.column.from_column = asked.source + 1;
    } else {
      proposed.column.from = name;
    }
    return proposed;
  }

  /// Programs that have left-handed frames usually say so above their tables.
  void doubt_handedness(ProposedMapping& result) const {
    if (!hints_.mirrored.empty()) return;
    const std::string above = small_letters(text_.substr(0, line_start(text_, found_.layout.first_line)));
    for (const char* const words : {"left-hand", "left hand", "linkshänd", "linkssystem"}) {
      if (above.find(words) == std::string::npos) continue;
      for (ProposedColumn& column : result.columns) {
        if (!column.column.name.starts_with("x_") && !column.column.name.starts_with("measured_x_")) continue;
        column.sense_doubt = "the lines above the table speak of a left-handed frame (--mirrored)";
      }
      return;
    }
  }

  /// Actual positions beside deviations tell the sign of these.
  void decide_deviation_sign(std::size_t actual, ProposedMapping& result) const {
    const auto of_base = [&](std::string_view base) {
      return std::find_if(result.columns.begin(), result.columns.end(),
                          [&](const ProposedColumn& column) { return column.column.name.starts_with(base); });
    };
    const ProposedColumn& target = *of_base("target_");
    ProposedColumn& deviation = *of_base("deviation_");
    PositionColumns columns{target.source,
                            deviation.source,
                            actual,
                            foreign_unit_named(target.column.unit),
                            foreign_unit_named(deviation.column.unit),
                            nullptr};
    columns.actual_unit = foreign_unit(facts_[actual].unit, columns.target_unit->quantity);
    if (columns.actual_unit == nullptr) columns.actual_unit = columns.target_unit;
    const int sign = deviation_sign(text_, found_, columns);
    if (sign == 0) return;
    deviation.reason += fmt::format("; it is {} by {}", sign > 0 ? "actual less target" : "target less actual",
                                    column_words(actual, found_.names[actual]));
    if (sign < 0) deviation.column.convention = ImportConvention::reversed;
  }

  std::string_view text_;
  const std::string& file_;
  const FoundLayout& found_;
  const Machine* machine_;
  const ImportHints& hints_;
  std::vector<ColumnFacts> facts_;
};

}  // namespace

ProposedMapping propose_mapping(std::string_view text, const std::string& file, const FoundLayout& found,
                                std::optional<ImportKind> kind, const Machine* machine, const ImportHints& hints) {
  ProposedMapping result = Proposer(text, file, found, machine, hints).proposed(kind);
  const auto none = [&](std::string_view base) {
    return std::none_of(result.columns.begin(), result.columns.end(), [&](const ProposedColumn& column) {
      return column.column.name.starts_with(fmt::format("{}_", base));
    });
  };
  const auto refuse = [](const char* option, const char* what) {
    throw InputError({.field = option}, fmt::format("the table has no {}", what), "no such option");
  };
  if (hints.clockwise && none("azimuth")) refuse("--azimuth", "azimuth");
  if (hints.zenith && none("elevation")) refuse("--vertical", "vertical angle");
  if (!hints.mirrored.empty() && none(hints.mirrored) && none("measured_" + hints.mirrored)) {
    refuse("--mirrored", "such coordinate");
  }
  return result;
}

}  // namespace abbe
