#include "abbe/formats/import/column_proposal.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "abbe/formats/import/column_match.h"
#include "abbe/formats/import/foreign_row.h"
#include "abbe/formats/import/foreign_word.h"

namespace abbe {
namespace {

constexpr double kWholeTurn = 360, kHalfTurn = 180, kQuarterTurn = 90;  // degrees
constexpr double kTravelMargin = 1e-6;                                  // mm or rad, as readers of commands allow

std::string range_words(const ColumnFacts& file) {
  return fmt::format("range {:.6g} to {:.6g}", file.smallest, file.largest);
}

bool is_in_travel(const Axis& axis, const ForeignUnit& unit, const ColumnFacts& file) {
  if (axis.endless) return true;
  return inside_number(unit, file.smallest) >= axis.travel_min - kTravelMargin &&
         inside_number(unit, file.largest) <= axis.travel_max + kTravelMargin;
}

class ColumnDecision {
 public:
  ColumnDecision(const ColumnCase& asked, const ImportHints& hints)
      : asked_(asked), hints_(hints), wanted_(*asked.wanted), file_(*asked.file) {
    result_.source = asked.source;
    if (!asked.doubt.empty()) result_.doubts.push_back(asked.doubt);
    result_.reason = asked.own_name       ? "has the name that Abbe reads"
                     : file_.name.empty() ? "by its place"
                                          : "by its name";
  }

  ProposedColumn decide() {
    std::string suffix;
    if (wanted_.holds == ImportColumn::Holds::number && wanted_.quantity != Quantity::dimensionless) {
      const ForeignUnit& unit = unit_of_column();
      result_.column.unit = unit.name;
      suffix = unit.suffix;
      if (wanted_.base == "azimuth") decide_sense();
      if (wanted_.base == "elevation") decide_vertical(unit);
      decide_mirror();
    }
    if (holds_direction(wanted_)) decide_directions();
    result_.column.name = import_header(wanted_, suffix);
    return std::move(result_);
  }

 private:
  void because(const std::string& words) { result_.reason += "; " + words; }
  void doubt(const std::string& words) { result_.doubts.push_back(words); }

  const ForeignUnit& unit_of_column() {
    if (file_.sexagesimal > 0) {
      because("degrees, minutes and seconds");
      if (file_.numbers > 0) doubt("some angles are plain numbers, others have minutes");
      return *foreign_unit_named("deg-min-sec");
    }
    if (!file_.unit.empty()) {
      because(fmt::format("{} says {}", asked_.unit_in_header ? "the header" : "the row of units", file_.unit));
      const ForeignUnit& unit = *foreign_unit(file_.unit, wanted_.quantity);
      if (small_letters(file_.unit) == "grad") doubt("'grad' is a degree in German and 0.9 degrees elsewhere");
      return unit;
    }
    const std::string& given = wanted_.quantity == Quantity::length ? hints_.length_unit : hints_.angle_unit;
    if (!given.empty()) {
      because(fmt::format("{} as given", given));
      return *foreign_unit_named(given);
    }
    if (hints_.polar && wanted_.group == "polar") {
      const PolarOrder& polar = *hints_.polar;
      const std::string& tried = wanted_.quantity == Quantity::length ? polar.length_unit : polar.angle_unit;
      if (!tried.empty()) {
        doubt(fmt::format("states no unit; {} is tried", tried));
        return *foreign_unit_named(tried);
      }
    }
    return wanted_.quantity == Quantity::length ? unit_of_length() : unit_of_angle();
  }

  const ForeignUnit& unit_of_length() {
    const ForeignUnit& mm = *foreign_unit_named("mm");
    if (asked_.axis != nullptr && is_in_travel(*asked_.axis, mm, file_) &&
        !is_in_travel(*asked_.axis, *foreign_unit_named("inch"), file_)) {
      because(fmt::format("millimetres: {} is in the travel, and would not be in inches", range_words(file_)));
      return mm;
    }
    if (wanted_.base == "deviation") {
      // Of machines; a deviation of a whole millimetre is rare, one of a thousandth of a micrometre too.
      const bool um = std::max(std::abs(file_.smallest), std::abs(file_.largest)) >= 0.5;
      doubt(fmt::format("states no unit; {} are assumed: {}", um ? "micrometres" : "millimetres", range_words(file_)));
      return um ? *foreign_unit_named("um") : mm;
    }
    doubt(fmt::format("states no unit; millimetres are assumed ({}; --length-unit)", range_words(file_)));
    return mm;
  }

  const ForeignUnit& unit_of_angle() {
    const double largest = std::max(std::abs(file_.smallest), std::abs(file_.largest));
    if (largest <= 2 * std::numbers::pi) {
      const bool rad = largest > 0 && asked_.axis == nullptr;
      doubt(fmt::format("states no unit; {} are assumed, others are possible ({}; --angle-unit)",
                        rad ? "radians" : "degrees", range_words(file_)));
      return *foreign_unit_named(rad ? "rad" : "deg");
    }
    if (largest > kWholeTurn && largest <= 400 && asked_.axis == nullptr) {
      doubt(fmt::format("states no unit; gon is assumed ({}; --angle-unit)", range_words(file_)));
      return *foreign_unit_named("gon");
    }
    because(fmt::format("degrees: {}", range_words(file_)));
    if (asked_.axis == nullptr) doubt("states no unit; it may be gon as well (--angle-unit)");
    return *foreign_unit_named("deg");
  }

  /// Azimuths that count clockwise.
  void decide_sense() {
    if (hints_.clockwise) {
      result_.column.convention = *hints_.clockwise ? ImportConvention::clockwise : ImportConvention::as_written;
      because(*hints_.clockwise ? "clockwise as given" : "from x towards y as given");
      return;
    }
    if (asked_.own_name) return;
    const std::string word = comparable_word(file_.name);
    if (word.find("clockwise") != std::string::npos || word.ends_with(" cw")) {
      result_.column.convention = ImportConvention::clockwise;
      because("clockwise by its name");
      return;
    }
    const bool by_custom = word.starts_with("hz") || word == "bearing" || word == "richtung" ||
                           word == "horizontalrichtung" || word == "ha";
    if (by_custom) result_.column.convention = ImportConvention::clockwise;
    result_.sense_doubt =
        fmt::format("states no sense; {} (--azimuth)", by_custom ? "clockwise is assumed, as theodolites count"
                                                                 : "from x towards y is assumed, as Abbe counts");
  }

  /// Angles from the zenith.
  void decide_vertical(const ForeignUnit& unit) {
    const double to_degrees = inside_number(unit, 1) * kHalfTurn / std::numbers::pi;
    const double smallest = file_.smallest * to_degrees, largest = file_.largest * to_degrees;
    const bool known = file_.numbers > 0;
    const bool can_be_zenith = !known || (smallest >= 0 && largest <= kHalfTurn);
    const bool can_be_elevation = !known || (smallest >= -kQuarterTurn && largest <= kQuarterTurn);
    const std::string word = comparable_word(file_.name);
    const bool named_zenith = word.find("zen") != std::string::npos || word == "vz";
    const bool named_elevation =
        asked_.own_name || word.starts_with("el") || word == "höhenwinkel" || word == "hoehenwinkel";
    bool zenith = named_zenith;
    if (hints_.zenith) {
      zenith = *hints_.zenith;
      because(zenith ? "from the zenith as given" : "from the horizontal as given");
    } else if (named_zenith || named_elevation) {
      because(named_zenith ? "from the zenith by its name" : "from the horizontal by its name");
    } else if (can_be_zenith != can_be_elevation) {
      zenith = can_be_zenith;
      because(fmt::format("{}: {}", zenith ? "from the zenith" : "from the horizontal", range_words(file_)));
    } else {
      zenith = known && smallest + largest > kQuarterTurn;
      doubt(fmt::format("may count from the horizontal or from the zenith; {} is assumed ({}; --vertical)",
                        zenith ? "the zenith" : "the horizontal", range_words(file_)));
    }
    if (!(zenith ? can_be_zenith : can_be_elevation)) {
      doubt(fmt::format("{} is not that of angles {}", range_words(file_),
                        zenith ? "from the zenith, 0 to 180 degrees" : "from the horizontal, -90 to 90 degrees"));
    }
    if (zenith) result_.column.convention = ImportConvention::zenith;
  }

  void decide_mirror() {
    if (hints_.mirrored.empty()) return;
    if (wanted_.base != hints_.mirrored && wanted_.base != "measured_" + hints_.mirrored &&
        wanted_.base != "n" + hints_.mirrored) {
      return;
    }
    result_.column.convention = ImportConvention::reversed;
    because("reversed as given: the frame is left-handed");
  }

  void decide_directions() {
    const bool rotation = wanted_.holds == ImportColumn::Holds::rotation;
    bool usual = true;
    for (const std::string& word : file_.words) {
      const bool positive = direction_of_word(wanted_.holds, word) > 0;
      (positive ? result_.column.positive : result_.column.negative).push_back(word);
      usual = usual && (rotation ? word == "cw" || word == "ccw" : word == "+" || word == "-");
    }
    if (usual) {
      result_.column.positive.clear();
      result_.column.negative.clear();
      return;
    }
    because(fmt::format("{} is {}, {} is {}", rotation ? "ccw" : "+", fmt::join(result_.column.positive, ", "),
                        rotation ? "cw" : "-", fmt::join(result_.column.negative, ", ")));
  }

  const ColumnCase& asked_;
  const ImportHints& hints_;
  const ImportColumn& wanted_;
  const ColumnFacts& file_;
  ProposedColumn result_;
};

}  // namespace

ProposedColumn proposed_column(const ColumnCase& asked, const ImportHints& hints) {
  return ColumnDecision(asked, hints).decide();
}

}  // namespace abbe
