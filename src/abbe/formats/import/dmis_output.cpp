// Points of DMIS output files (ISO 22093); docs/import.md has the sources.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>

#include "abbe/formats/import/foreign_word.h"
#include "abbe/formats/import/instrument_lines.h"
#include "abbe/formats/import/instrument_points.h"
#include "abbe/formats/import/instrument_readers.h"
#include "abbe/formats/import/instrument_xml.h"
#include "abbe/formats/text/csv_header.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/list_text.h"

namespace abbe {
namespace {

/// A statement: "FA(P1)=FEAT/POINT,CART,..." has the label "FA(P1)", the word "FEAT" and its parameters.
struct DmisStatement {
  std::string_view label, word;
  std::vector<std::string_view> parameters;
};

/// In any case of letters.
bool is_dmis_word(std::string_view text, std::string_view capitals) {
  return text.size() == capitals.size() && small_letters(text) == small_letters(capitals);
}

/// Parameters between commas; those in quotes may have commas.
std::vector<std::string_view> dmis_parameters(std::string_view text) {
  std::vector<std::string_view> parameters;
  bool quoted = false;
  std::size_t begin = 0;
  for (std::size_t at = 0; at <= text.size(); ++at) {
    if (at < text.size() && text[at] == '\'') quoted = !quoted;
    if (at < text.size() && (quoted || text[at] != ',')) continue;
    parameters.push_back(csv_trimmed(text.substr(begin, at - begin)));
    begin = at + 1;
  }
  return parameters;
}

DmisStatement dmis_statement(std::string_view text) {
  DmisStatement statement;
  const std::size_t slash = text.find('/');
  std::string_view head = csv_trimmed(text.substr(0, slash));
  const std::size_t equals = head.find('=');
  if (equals != std::string_view::npos) {
    statement.label = csv_trimmed(head.substr(0, equals));
    head = csv_trimmed(head.substr(equals + 1));
  }
  statement.word = head;
  if (slash != std::string_view::npos) statement.parameters = dmis_parameters(text.substr(slash + 1));
  return statement;
}

/// "P1" of "FA(P1)"; nothing if the label is not one of that kind.
std::optional<std::string_view> dmis_name(std::string_view label, std::string_view kind) {
  const std::size_t open = label.find('(');
  if (open == std::string_view::npos || !label.ends_with(')') ||
      !is_dmis_word(csv_trimmed(label.substr(0, open)), kind)) {
    return std::nullopt;
  }
  return csv_trimmed(label.substr(open + 1, label.size() - open - 2));
}

class DmisReader {
 public:
  DmisReader(std::string_view text, const std::string& file, const ImportHints& hints)
      : lines_(text), file_(file), hints_(hints) {}

  InstrumentTable read() {
    while (lines_.next()) {
      std::string_view text = lines_.text();
      if (text.starts_with("$$")) continue;
      if (statement_.empty()) line_ = lines_.number();
      const bool goes_on = text.ends_with('$');
      if (goes_on) text.remove_suffix(1);
      statement_ += text;
      if (goes_on) continue;
      take_statement();
      statement_.clear();
    }
    if (!statement_.empty()) refuse("", "the last statement continues in a line that is missing", "a line below '$'");
    write();
    return std::move(table_);
  }

 private:
  [[noreturn]] void refuse(const std::string& field, const std::string& problem, const std::string& expected) const {
    throw InputError({.file = file_, .line = line_, .field = field}, problem, expected);
  }

  void take_statement() {
    const DmisStatement statement = dmis_statement(statement_);
    if (is_dmis_word(statement.word, "ENDFIL")) {
      has_end_ = true;
    } else if (is_dmis_word(statement.word, "UNITS")) {
      take_units(statement);
    } else if (is_dmis_word(statement.word, "FEAT")) {
      take_feature(statement);
    } else {
      if (changes_frame(statement)) frame_line_ = line_;
      if (is_dmis_word(statement.word, "FILNAM") || is_dmis_word(statement.word, "DMISMN")) {
        table_.facts.push_back({std::string(statement.word), fmt::format("{}", fmt::join(statement.parameters, ","))});
        return;
      }
      if (!statement.word.empty()) ++not_read_[shown_text(statement.word)];
    }
  }

  void take_units(const DmisStatement& statement) {
    constexpr std::array<std::pair<std::string_view, const char*>, 5> kUnits = {
        {{"MM", "mm"}, {"CM", "cm"}, {"M", "m"}, {"INCH", "inch"}, {"FEET", "foot"}}};
    const std::string_view given = statement.parameters.empty() ? "" : statement.parameters.front();
    const auto found =
        std::find_if(kUnits.begin(), kUnits.end(), [&](const auto& one) { return is_dmis_word(given, one.first); });
    if (found == kUnits.end()) {
      refuse("UNITS", fmt::format("'{}' is not a unit of DMIS", shown_text(given)), "MM, CM, M, INCH or FEET");
    }
    const bool read_before = !actual_.empty() || !nominal_.empty();
    if (read_before && unit_ != found->second) {
      refuse("UNITS",
             fmt::format("the unit becomes {} behind points in {}", found->second, unit_.empty() ? "none" : unit_),
             "one unit for all points");
    }
    unit_ = found->second;
  }

  /// Statements that make or recall a coordinate system: features are given in the one that is there.
  static bool changes_frame(const DmisStatement& statement) {
    const auto is_frame = [](std::string_view label) { return dmis_name(label, "D") || dmis_name(label, "DA"); };
    if (is_dmis_word(statement.word, "RECALL")) {
      return std::any_of(statement.parameters.begin(), statement.parameters.end(), is_frame);
    }
    return is_frame(statement.label);
  }

  void take_feature(const DmisStatement& statement) {
    const std::optional<std::string_view> actual = dmis_name(statement.label, "FA");
    const std::optional<std::string_view> nominal = dmis_name(statement.label, "F");
    if (!actual && !nominal) {
      refuse("FEAT", fmt::format("'{}' is no label of a feature", shown_text(statement.label)), "FA(NAME) or F(NAME)");
    }
    const std::string_view type = statement.parameters.empty() ? "" : statement.parameters.front();
    if (!is_dmis_word(type, "POINT")) {
      ++not_read_[fmt::format("{} FEAT/{}", actual ? "FA" : "F", shown_text(type))];
      return;
    }
    const std::string field(statement.label);
    const std::string expected =
        fmt::format("FEAT/POINT,CART,x,y,z,i,j,k with coordinates in {}", unit_.empty() ? "the unit of UNITS" : unit_);
    if (statement.parameters.size() < 2 || !is_dmis_word(statement.parameters[1], "CART")) {
      refuse(field, "the point is not in Cartesian coordinates", expected);
    }
    if (statement.parameters.size() != 8) {
      refuse(field, "the point has " + counted(statement.parameters.size() - 2, "number", "numbers"), expected);
    }
    for (std::size_t k = 2; k < 8; ++k) instrument_number(statement.parameters[k], file_, line_, field, expected);
    const auto numbers = [&](std::size_t first) {
      return std::array<std::string_view, 3>{statement.parameters[first], statement.parameters[first + 1],
                                             statement.parameters[first + 2]};
    };
    const std::array<std::string_view, 3> normal = numbers(5);
    InstrumentPoints& points = actual ? actual_ : nominal_;
    if (frame_line_ != 0 && !(actual_.empty() && nominal_.empty())) changed_line_ = frame_line_;
    frame_line_ = 0;
    points.add(actual ? *actual : *nominal, numbers(2), line_, &normal);
  }

  void write() {
    const InstrumentPoints& points = actual_.empty() ? nominal_ : actual_;
    line_ = 0;
    if (points.empty()) refuse("FEAT", "there are no points", "FA(NAME)=FEAT/POINT,CART,x,y,z,i,j,k");
    PointUnit unit{unit_, true, fmt::format("UNITS says {}", unit_), ""};
    if (unit_.empty() && !hints_.length_unit.empty()) {
      unit = {hints_.length_unit, true, hints_.length_unit + " as given", ""};
    } else if (unit_.empty()) {
      unit = {"mm", false, "there is no UNITS", "states no unit; millimetres are assumed (--length-unit)"};
    }
    points.write(unit, {"label", "x", "y", "z", "i", "j", "k"}, table_);
    table_.reasons.push_back(counted(points.count(), actual_.empty() ? "nominal point" : "measured point",
                                     actual_.empty() ? "nominal points" : "measured points"));
    if (actual_.empty()) {
      table_.doubts.emplace_back("there are points F(...), which are nominal, and none FA(...), which were measured");
    } else if (!nominal_.empty()) {
      not_read_["F FEAT/POINT"] = nominal_.count();
    }
    if (changed_line_ != 0) {
      table_.doubts.push_back(fmt::format("line {} changes the coordinate system between points", changed_line_));
    }
    if (!has_end_) table_.doubts.emplace_back("the file does not end in ENDFIL, so it may be cut short");
    table_.not_read = counted_names(not_read_);
  }

  InstrumentLines lines_;
  const std::string& file_;
  const ImportHints& hints_;
  InstrumentTable table_;
  InstrumentPoints actual_, nominal_;
  std::map<std::string, std::size_t> not_read_;
  std::string statement_, unit_;
  std::size_t line_ = 0, frame_line_ = 0, changed_line_ = 0;
  bool has_end_ = false;
};

}  // namespace

std::optional<Recognition> recognise_dmis_output(std::string_view text) {
  constexpr int kLooked = 200;
  InstrumentLines lines(text);
  for (int i = 0; i < kLooked && lines.next(); ++i) {
    if (lines.text().starts_with("$$")) continue;
    const DmisStatement statement = dmis_statement(lines.text());
    for (const char* const word : {"FILNAM", "DMISMN", "DMISMD"}) {
      if (is_dmis_word(statement.word, word) && !statement.parameters.empty()) {
        return Recognition{fmt::format("{} in line {}", word, lines.number())};
      }
    }
    if (is_dmis_word(statement.word, "FEAT") && !statement.parameters.empty() &&
        (dmis_name(statement.label, "FA") || dmis_name(statement.label, "F"))) {
      return Recognition{fmt::format("{}=FEAT/ in line {}", shown_text(statement.label), lines.number())};
    }
  }
  return std::nullopt;
}

InstrumentTable read_dmis_output(std::string_view text, const std::string& file, const ImportHints& hints) {
  return DmisReader(text, file, hints).read();
}

}  // namespace abbe
