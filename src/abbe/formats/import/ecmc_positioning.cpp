// Readings of positioning tests as the tools of ecmc write them: "REF_DATA_FWD[2,1]=-14.99"; docs/import.md has the
// sources.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "abbe/formats/import/foreign_unit.h"
#include "abbe/formats/import/instrument_lines.h"
#include "abbe/formats/import/instrument_readers.h"
#include "abbe/formats/text/csv_header.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/list_text.h"

namespace abbe {
namespace {

constexpr std::string_view kEcmcTarget = "TGT_DATA[", kEcmcForward = "REF_DATA_FWD[", kEcmcBackward = "REF_DATA_BWD[";
constexpr std::size_t kMostEcmcIndex = 100000;

/// A number as it is written, and its line.
struct EcmcNumber {
  std::string text;
  std::size_t line = 0;
};

/// Run and direction, then position: the order of the rows.
struct EcmcPlace {
  std::size_t cycle = 0;
  bool backward = false;
  std::size_t position = 0;
  auto operator<=>(const EcmcPlace&) const = default;
};

class EcmcReader {
 public:
  EcmcReader(std::string_view text, const std::string& file) : lines_(text), file_(file) {}

  InstrumentTable read() {
    while (lines_.next()) take_line();
    if (readings_.empty()) {
      throw InputError({.file = file_}, "there are no readings", "lines such as REF_DATA_FWD[1,1]=-20.0492");
    }
    table_.kind = ImportKind::positioning;
    write_columns();
    for (const auto& [place, number] : readings_) {
      const auto target = targets_.find(place.position);
      if (target == targets_.end()) {
        throw InputError({.file = file_, .line = number.line}, fmt::format("position {} has no target", place.position),
                         fmt::format("a line TGT_DATA[{}]=", place.position));
      }
      table_.rows +=
          fmt::format("{},{},{},{}\n", place.cycle, place.backward ? '-' : '+', target->second.text, number.text);
      table_.lines.push_back(number.line);
    }
    look_at_counts();
    return std::move(table_);
  }

 private:
  [[noreturn]] void refuse(const std::string& field, const std::string& problem, const std::string& expected) const {
    throw InputError({.file = file_, .line = lines_.number(), .field = field}, problem, expected);
  }

  void take_line() {
    const std::string_view line = lines_.text();
    // The first line of files that a script wrote begins "TEST_DATA=# Input data file".
    if (line.starts_with('#') || line.starts_with("TEST_DATA=#")) return;
    const std::size_t equals = line.find('=');
    if (equals == std::string_view::npos) {
      refuse("", fmt::format("'{}' has no '='", shown_text(line)), "NAME=VALUE, or a comment after #");
    }
    const std::string_view key = csv_trimmed(line.substr(0, equals)), value = csv_trimmed(line.substr(equals + 1));
    if (key.starts_with(kEcmcTarget)) {
      const std::vector<std::size_t> index = indices(key, 1);
      if (!targets_.emplace(index[0], number(key, value)).second) refuse_again(key);
    } else if (key.starts_with(kEcmcForward) || key.starts_with(kEcmcBackward)) {
      const std::vector<std::size_t> index = indices(key, 2);
      const EcmcPlace place{index[1], key.starts_with(kEcmcBackward), index[0]};
      if (!readings_.emplace(place, number(key, value)).second) refuse_again(key);
    } else if (key == "UNIT") {
      take_unit(value);
    } else if (key == "CYCLES" || key == "POSITIONS") {
      (key == "CYCLES" ? cycles_ : positions_) =
          instrument_count(value, 1, kMostEcmcIndex, file_, lines_.number(), std::string(key));
    } else {
      table_.facts.push_back({shown_text(key), shown_text(value)});
    }
  }

  void refuse_again(std::string_view key) const {
    refuse(shown_text(key), "it is there twice", "one line for each position and cycle");
  }

  /// The whole numbers in the brackets of a key.
  std::vector<std::size_t> indices(std::string_view key, std::size_t count) const {
    const std::string_view expected = count == 1 ? "[position]" : "[position,cycle]";
    const std::size_t open = key.find('[');
    if (!key.ends_with(']')) refuse(shown_text(key), "the bracket is not closed", std::string(expected));
    std::string_view inside = key.substr(open + 1, key.size() - open - 2);
    std::vector<std::size_t> result;
    for (;;) {
      const std::size_t comma = std::min(inside.find(','), inside.size());
      result.push_back(instrument_count(csv_trimmed(inside.substr(0, comma)), 1, kMostEcmcIndex, file_, lines_.number(),
                                        shown_text(key)));
      if (comma == inside.size()) break;
      inside.remove_prefix(comma + 1);
    }
    if (result.size() != count) {
      refuse(shown_text(key), "has " + counted(result.size(), "number", "numbers") + " in brackets",
             std::string(expected));
    }
    return result;
  }

  EcmcNumber number(std::string_view key, std::string_view value) const {
    instrument_number(value, file_, lines_.number(), shown_text(key), "a position in the unit of the file");
    return {std::string(value), lines_.number()};
  }

  void take_unit(std::string_view value) {
    unit_ = foreign_unit(value, Quantity::length);
    if (unit_ == nullptr) unit_ = foreign_unit(value, Quantity::angle);
    if (unit_ == nullptr || unit_->sexagesimal) {
      refuse("UNIT", fmt::format("'{}' is not a unit of a position", shown_text(value)), "mm, um, deg, ...");
    }
    unit_is_stated_ = true;
  }

  void write_columns() {
    if (unit_ == nullptr) unit_ = foreign_unit_named("mm");
    const std::string unit(unit_->name);
    const std::string reason =
        unit_is_stated_ ? fmt::format("UNIT says {}", unit) : "the file states no UNIT, which then is mm";
    InstrumentColumn direction{"direction", "direction", "", true, "FWD is +, BWD is -"};
    direction.doubts.emplace_back(
        "the description of the form calls FWD forward, and a program that reads it takes FWD as the way back");
    table_.columns = {{"cycle", "run", "", true, "the second number in brackets"},
                      std::move(direction),
                      {"TGT_DATA", "target", unit, true, reason},
                      {"REF_DATA", "actual", unit, true, reason}};
    table_.reasons.push_back(counted(readings_.size(), "reading", "readings") + " of " +
                             counted(targets_.size(), "target", "targets"));
  }

  /// A file that was cut short has fewer readings than it states.
  void look_at_counts() {
    const std::size_t stated = 2 * cycles_ * positions_;
    if (stated == 0 || stated == readings_.size()) return;
    table_.doubts.push_back(
        fmt::format("the file states {} positions and {} cycles, {} readings in both directions, "
                    "and has {}",
                    positions_, cycles_, stated, readings_.size()));
  }

  InstrumentLines lines_;
  const std::string& file_;
  InstrumentTable table_;
  std::map<std::size_t, EcmcNumber> targets_;
  std::map<EcmcPlace, EcmcNumber> readings_;
  const ForeignUnit* unit_ = nullptr;
  bool unit_is_stated_ = false;
  std::size_t cycles_ = 0, positions_ = 0;
};

}  // namespace

std::optional<Recognition> recognise_ecmc_positioning(std::string_view text) {
  constexpr int kLooked = 60;
  InstrumentLines lines(text);
  bool target = false;
  for (int seen = 0; seen < kLooked && lines.next(); ++seen) {
    target = target || lines.text().starts_with(kEcmcTarget);
    const bool reading = lines.text().starts_with(kEcmcForward) || lines.text().starts_with(kEcmcBackward);
    if (target && reading) return Recognition{"lines TGT_DATA and REF_DATA"};
  }
  return std::nullopt;
}

InstrumentTable read_ecmc_positioning(std::string_view text, const std::string& file, const ImportHints&) {
  return EcmcReader(text, file).read();
}

}  // namespace abbe
