#include "abbe/formats/import/column_match.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "abbe/formats/import/foreign_row.h"
#include "abbe/formats/import/foreign_unit.h"
#include "abbe/formats/import/foreign_word.h"
#include "abbe/formats/text/csv_header.h"

namespace abbe {
namespace {

// Only the order of these counts.
constexpr double kOwnName = 5, kOwnCase = 4, kKnownWord = 3, kOtherCase = 2, kNextWord = 1e-3;

/// A few other fields are mistakes, which are told where the rows are read.
bool holds_numbers(const ColumnFacts& file) {
  const std::size_t numbers = file.numbers + file.sexagesimal;
  return numbers > 0 && numbers >= file.texts;
}

bool holds_directions(ImportColumn::Holds holds, const ColumnFacts& file) {
  return !file.more_words && !file.words.empty() &&
         std::all_of(file.words.begin(), file.words.end(),
                     [holds](const auto& word) { return direction_of_word(holds, word) != 0; });
}

/// Whether the rows and the unit of a file's column can be what is wanted.
bool can_be(const ImportColumn& wanted, const ColumnFacts& file) {
  switch (wanted.holds) {
    case ImportColumn::Holds::number:
      break;
    case ImportColumn::Holds::name:
      return file.numbers + file.sexagesimal + file.texts > 0;
    case ImportColumn::Holds::label:
      return file.unit.empty();
    case ImportColumn::Holds::direction:
    case ImportColumn::Holds::rotation:
      return holds_directions(wanted.holds, file);
  }
  if (!holds_numbers(file)) return false;
  if (wanted.quantity == Quantity::dimensionless) return file.unit.empty();
  if (file.sexagesimal > 0 && wanted.quantity != Quantity::angle) return false;
  // Nothing needs times; without their unit they may be anything.
  if (wanted.quantity == Quantity::time && file.unit.empty()) return false;
  return file.unit.empty() || foreign_unit(file.unit, wanted.quantity) != nullptr;
}

bool is_own_name(const ImportColumn& wanted, const ColumnFacts& file) {
  const bool has_unit = wanted.holds == ImportColumn::Holds::number && wanted.quantity != Quantity::dimensionless;
  return has_unit ? unit_of_name(file.header, wanted.base, wanted.quantity) != nullptr : file.header == wanted.base;
}

/// Also where nothing stands between the words: "NomX" and "Xnom". Two letters, such as "ux", are another name.
bool is_same_word(const std::string& known, const std::string& word) {
  constexpr std::size_t kLeast = 5;  // "x nom"
  if (known == word) return true;
  if (known.size() < kLeast || word.find(' ') != std::string::npos) return false;
  std::string joined = known;
  joined.erase(std::remove(joined.begin(), joined.end(), ' '), joined.end());
  return joined == word;
}

double score_of(const ImportColumn& wanted, const ColumnFacts& file) {
  if (file.name.empty() || !can_be(wanted, file)) return 0;
  if (is_own_name(wanted, file)) return kOwnName;
  const std::string word = comparable_word(file.name);
  if (!wanted.exact_word.empty() && word == small_letters(wanted.exact_word)) {
    return comparable_word(file.name, true) == wanted.exact_word ? kOwnCase : kOtherCase;
  }
  const auto found = std::find_if(wanted.words.begin(), wanted.words.end(),
                                  [&](const std::string& known) { return is_same_word(known, word); });
  if (found == wanted.words.end()) return 0;
  return kKnownWord - kNextWord * static_cast<double>(found - wanted.words.begin());
}

/// Name and unit as a header has them where the unit is none that is known: "z_furlong", "X [furlong]".
std::pair<std::string, std::string> split_at_unknown_unit(const ColumnFacts& file) {
  if (!file.unit.empty()) return {file.name, file.unit};
  const std::size_t at = file.header.find_last_of("[(<_/");
  if (at == std::string::npos || at == 0) return {};
  const bool is_bracket = std::string_view("[(<").find(file.header[at]) != std::string_view::npos;
  const std::string rest = file.header.substr(is_bracket ? at : at + 1);
  return {std::string(csv_trimmed(std::string_view(file.header).substr(0, at))), std::string(without_brackets(rest))};
}

/// Takes away groups of which only a part was found, and what says the same twice.
class GroupCheck {
 public:
  GroupCheck(const std::vector<ImportColumn>& wanted, ColumnMatch& match) : wanted_(wanted), match_(match) {}

  bool has_all(const std::string& group) const {
    bool any = false;
    for (std::size_t i = 0; i < wanted_.size(); ++i) {
      if (wanted_[i].group != group) continue;
      if (match_.source[i] == kNoSource) return false;
      any = true;
    }
    return any;
  }
  void drop(const std::string& group) {
    for (std::size_t i = 0; i < wanted_.size(); ++i) {
      if (wanted_[i].group == group) match_.source[i] = kNoSource;
    }
  }
  void drop_parts() {
    for (const ImportColumn& column : wanted_) {
      if (!column.group.empty() && !has_all(column.group)) drop(column.group);
    }
  }
  bool has(const std::string& base) const {
    for (std::size_t i = 0; i < wanted_.size(); ++i) {
      if (wanted_[i].base == base && match_.source[i] != kNoSource) return true;
    }
    return false;
  }
  /// @returns where it was, or kNoSource
  std::size_t drop_base(const std::string& base) {
    std::size_t source = kNoSource;
    for (std::size_t i = 0; i < wanted_.size(); ++i) {
      if (wanted_[i].base == base && match_.source[i] != kNoSource) {
        source = std::exchange(match_.source[i], kNoSource);
      }
    }
    return source;
  }

 private:
  const std::vector<ImportColumn>& wanted_;
  ColumnMatch& match_;
};

/// Where a deviation states no unit it is what its target is: a length or an angle.
void follow_target(const std::vector<ImportColumn>& wanted, const std::vector<ColumnFacts>& file, ColumnMatch& match) {
  bool angles = false;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    angles =
        angles || (wanted[i].base == "target" && wanted[i].quantity == Quantity::angle && match.source[i] != kNoSource);
  }
  for (std::size_t i = 0; angles && i + 1 < wanted.size(); ++i) {
    if (match.source[i] == kNoSource || wanted[i].base == "target" || wanted[i + 1].base != wanted[i].base) continue;
    if (file[match.source[i]].unit.empty()) std::swap(match.source[i], match.source[i + 1]);
  }
}

/// A ball bar has angles with radii or deviations, a grid encoder two coordinates. A radius says more than a deviation.
void find_missing_of_circle(GroupCheck& groups, ColumnMatch& match) {
  const bool is_ball_bar = groups.has("angle") && (groups.has("radius") || groups.has("deviation"));
  int coordinates = 0;
  for (const char* const letter : {"X", "Y", "Z"}) coordinates += groups.has(letter) ? 1 : 0;
  if (is_ball_bar) {
    for (const char* const letter : {"X", "Y", "Z"}) groups.drop_base(letter);
    if (groups.has("radius")) groups.drop_base("deviation");
  } else if (coordinates == 2) {
    for (const char* const base : {"angle", "radius", "deviation"}) groups.drop_base(base);
  } else {
    match.missing.emplace_back(groups.has("angle") ? "deviation" : "angle");
  }
}

void find_missing(ImportKind kind, const std::vector<ImportColumn>& wanted, ColumnMatch& match) {
  GroupCheck groups(wanted, match);
  groups.drop_parts();
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    if (wanted[i].required && match.source[i] == kNoSource) match.missing.push_back(wanted[i].base);
  }
  if (kind == ImportKind::tracker) {
    if (groups.has_all("point")) groups.drop("polar");
    if (!groups.has_all("point")) groups.drop("u of the point");
    if (!groups.has_all("point") && !groups.has_all("polar")) match.missing.emplace_back("measured_x");
  }
  if (kind == ImportKind::positioning) {
    if (groups.has("deviation")) match.actual = groups.drop_base("actual");
    if (!groups.has("target")) match.missing.emplace_back("target");
    if (!groups.has("deviation") && !groups.has("actual")) match.missing.emplace_back("deviation");
  }
  if (kind == ImportKind::circular) find_missing_of_circle(groups, match);
}

ColumnMatch empty_match(std::size_t count) {
  return {std::vector<std::size_t>(count, kNoSource),
          std::vector<bool>(count),
          std::vector<std::string>(count),
          kNoSource,
          {}};
}

int rotation_of_word(const std::string& small) {
  constexpr std::array<std::string_view, 10> kAnticlockwise = {
      "ccw", "counterclockwise",   "counter-clockwise",  "anticlockwise", "anti-clockwise", "acw", "g3",
      "g03", "gegenuhrzeigersinn", "gegen uhrzeigersinn"};
  constexpr std::array<std::string_view, 6> kClockwise = {"cw",  "clockwise",     "g2",
                                                          "g02", "uhrzeigersinn", "im uhrzeigersinn"};
  if (std::find(kAnticlockwise.begin(), kAnticlockwise.end(), small) != kAnticlockwise.end()) return 1;
  return std::find(kClockwise.begin(), kClockwise.end(), small) != kClockwise.end() ? -1 : 0;
}

}  // namespace

int direction_of_word(ImportColumn::Holds holds, const std::string& word) {
  if (holds == ImportColumn::Holds::rotation) return rotation_of_word(small_letters(word));
  constexpr std::array<std::string_view, 16> kPositive = {"+",   "positive", "pos",     "forward", "forwards", "fwd",
                                                          "vor", "vorwärts", "hin",     "up",      "auf",      "1",
                                                          "+1",  "↑",        "positiv", "aufwärts"};
  constexpr std::array<std::string_view, 17> kNegative = {"-",    "negative", "neg", "backward", "backwards", "back",
                                                          "bwd",  "reverse",  "rev", "rück",     "rückwärts", "zurück",
                                                          "down", "ab",       "-1",  "↓",        "negativ"};
  const std::string small = small_letters(word);
  if (std::find(kPositive.begin(), kPositive.end(), small) != kPositive.end()) return 1;
  return std::find(kNegative.begin(), kNegative.end(), small) != kNegative.end() ? -1 : 0;
}

std::optional<WrongUnit> wrong_unit(const ImportColumn& wanted, const std::vector<ColumnFacts>& file) {
  if (wanted.holds != ImportColumn::Holds::number || wanted.quantity == Quantity::dimensionless) return std::nullopt;
  for (std::size_t k = 0; k < file.size(); ++k) {
    ColumnFacts without_unit = file[k];
    auto [name, unit] = split_at_unknown_unit(file[k]);
    if (unit.empty() || foreign_unit(unit, wanted.quantity) != nullptr) continue;
    without_unit.name = name;
    without_unit.unit.clear();
    const bool own_name = name == wanted.base && can_be(wanted, without_unit);
    if (own_name || score_of(wanted, without_unit) > 0) return WrongUnit{k, std::move(unit)};
  }
  return std::nullopt;
}

bool is_taken_by_order(const ImportColumn& column) {
  return column.holds == ImportColumn::Holds::number && (column.required || column.group == "point");
}

ColumnMatch match_by_names(ImportKind kind, const std::vector<ImportColumn>& wanted,
                           const std::vector<ColumnFacts>& file) {
  ColumnMatch match = empty_match(wanted.size());
  std::vector<bool> taken(file.size());
  std::vector<std::string> bases;
  for (;;) {
    double best = 0;
    std::size_t column = 0, source = kNoSource;
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      if (std::find(bases.begin(), bases.end(), wanted[i].base) != bases.end()) continue;
      for (std::size_t k = 0; k < file.size(); ++k) {
        const double score = taken[k] ? 0 : score_of(wanted[i], file[k]);
        if (score <= best) continue;
        best = score;
        column = i;
        source = k;
      }
    }
    if (source == kNoSource) break;
    for (std::size_t k = source + 1; k < file.size(); ++k) {
      if (taken[k] || score_of(wanted[column], file[k]) != best) continue;
      match.doubts[column] = fmt::format("{} has the same name", column_words(k, file[k].name));
    }
    taken[source] = true;
    match.source[column] = source;
    match.own_name[column] = best == kOwnName;
    bases.push_back(wanted[column].base);
  }
  if (kind == ImportKind::positioning) follow_target(wanted, file, match);
  find_missing(kind, wanted, match);
  return match;
}

ColumnMatch match_by_order(ImportKind kind, const std::vector<ImportColumn>& wanted,
                           const std::vector<ColumnFacts>& file, const PolarOrder* polar) {
  ColumnMatch match = empty_match(wanted.size());
  std::vector<std::size_t> numbers, ordered;
  std::size_t text = kNoSource;
  for (std::size_t k = 0; k < file.size(); ++k) {
    if (holds_numbers(file[k])) {
      numbers.push_back(k);
    } else if (text == kNoSource && file[k].texts > 0) {
      text = k;
    }
  }
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    if (polar == nullptr ? is_taken_by_order(wanted[i]) : wanted[i].required || wanted[i].group == "polar") {
      ordered.push_back(i);
    }
    if (wanted[i].holds == ImportColumn::Holds::label) match.source[i] = text;
  }
  // Of the columns of a kind, range comes before azimuth and elevation.
  if (polar != nullptr && !polar->range_first && ordered.size() >= 3) {
    std::rotate(ordered.end() - 3, ordered.end() - 2, ordered.end());
  }
  // A tracker's columns count; behind three coordinates there may be anything.
  const bool fits = kind == ImportKind::points ? numbers.size() >= ordered.size()
                                               : kind == ImportKind::tracker && numbers.size() == ordered.size();
  for (std::size_t i = 0; fits && i < ordered.size(); ++i) {
    match.source[ordered[i]] = numbers[i];
    match.doubts[ordered[i]] = "there are no column names; the columns are taken in their order";
  }
  find_missing(kind, wanted, match);
  return match;
}

}  // namespace abbe
