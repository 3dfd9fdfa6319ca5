#include "abbe/formats/import/foreign_unit.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "abbe/formats/import/foreign_word.h"
#include "abbe/formats/text/csv_header.h"

namespace abbe {
namespace {

struct NamedUnit {
  ForeignUnit unit;
  std::vector<std::string_view> written;  // in small letters
};

/// 1 inch = 25.4 mm, 1 foot = 304.8 mm (international yard and pound agreement, 1959); 1 gon = 0.9 degrees.
const std::vector<NamedUnit>& all_units() {
  static const std::vector<NamedUnit> units = {
      {{"mm", Quantity::length, "mm"}, {"mm", "millimeter", "millimeters", "millimetre", "millimetres"}},
      {{"um", Quantity::length, "um"},
       {"um", "µm", "μm", "micron", "microns", "micrometer", "micrometre", "mikrometer", "my"}},
      {{"m", Quantity::length, "m"}, {"m", "meter", "meters", "metre", "metres"}},
      {{"cm", Quantity::length, "mm", 1, 1}, {"cm", "centimeter", "centimetre", "zentimeter"}},
      {{"nm", Quantity::length, "um", 1, -3}, {"nm", "nanometer", "nanometre"}},
      {{"inch", Quantity::length, "mm", 254, -1}, {"inch", "inches", "in", "zoll", "\""}},
      {{"thou", Quantity::length, "um", 254, -1}, {"thou", "mil", "mils"}},
      {{"uinch", Quantity::length, "um", 254, -4}, {"uin", "µin", "μin", "uinch", "microinch", "microinches"}},
      {{"foot", Quantity::length, "mm", 3048, -1}, {"ft", "foot", "feet"}},
      {{"deg", Quantity::angle, "deg"}, {"deg", "°", "degree", "degrees", "grad", "altgrad"}},
      {{"rad", Quantity::angle, "rad"}, {"rad", "radian", "radians"}},
      {{"mrad", Quantity::angle, "mrad"}, {"mrad"}},
      {{"urad", Quantity::angle, "urad"}, {"urad", "µrad", "μrad"}},
      {{"gon", Quantity::angle, "deg", 9, -1}, {"gon", "gons", "gradian", "gradians", "neugrad"}},
      {{"arcmin", Quantity::angle, "arcsec", 60}, {"arcmin", "'", "′", "arc min", "bogenminuten"}},
      {{"arcsec", Quantity::angle, "arcsec"},
       {"arcsec", "arc sec", "\"", "''", "″", "arcsecond", "arcseconds", "bogensekunden"}},
      {{"deg-min-sec", Quantity::angle, "arcsec", 1, 0, true},
       {"deg-min-sec", "dms", "d m s", "d:m:s", "dd:mm:ss", "dd mm ss", "° ' \"", "°'\"", "gms"}},
      {{"s", Quantity::time, "s"}, {"s", "sec", "second", "seconds", "sekunde", "sekunden"}},
      {{"ms", Quantity::time, "ms"}, {"ms", "msec", "millisecond", "milliseconds"}},
      {{"min", Quantity::time, "s", 60}, {"min", "minute", "minutes", "minuten"}},
      {{"h", Quantity::time, "s", 3600}, {"h", "hour", "hours", "stunden"}},
  };
  return units;
}

/// The unit behind a mark of the header, if it is one: "X/mm" for "/".
bool take_unit_behind(std::string_view header, std::string_view mark, std::pair<std::string, std::string>& result) {
  const std::size_t at = header.rfind(mark);
  if (at == std::string_view::npos || at == 0) return false;
  const std::string_view name = csv_trimmed(header.substr(0, at)), unit = csv_trimmed(header.substr(at + mark.size()));
  if (name.empty() || !is_foreign_unit(without_brackets(unit))) return false;
  result = {std::string(name), std::string(without_brackets(unit))};
  return true;
}

}  // namespace

double inside_number(const ForeignUnit& unit, double number) {
  const Unit& read = unit_named(unit.quantity, unit.suffix);
  return number * unit.factor * std::pow(10.0, unit.shift + read.decimal_shift) * read.factor;
}

const ForeignUnit* foreign_unit_named(std::string_view name) {
  for (const NamedUnit& one : all_units()) {
    if (one.unit.name == name) return &one.unit;
  }
  return nullptr;
}

std::vector<std::string_view> foreign_unit_names(Quantity quantity) {
  std::vector<std::string_view> names;
  for (const NamedUnit& one : all_units()) {
    if (one.unit.quantity == quantity) names.push_back(one.unit.name);
  }
  return names;
}

const ForeignUnit* foreign_unit(std::string_view written, Quantity quantity) {
  const std::string small = small_letters(csv_trimmed(written));
  for (const NamedUnit& one : all_units()) {
    if (one.unit.quantity != quantity) continue;
    if (std::find(one.written.begin(), one.written.end(), small) != one.written.end()) return &one.unit;
  }
  return nullptr;
}

bool is_foreign_unit(std::string_view written) {
  return foreign_unit(written, Quantity::length) != nullptr || foreign_unit(written, Quantity::angle) != nullptr ||
         foreign_unit(written, Quantity::time) != nullptr;
}

std::string_view without_brackets(std::string_view text) {
  text = csv_trimmed(text);
  constexpr std::array<std::string_view, 3> kBrackets = {"[]", "()", "<>"};
  for (const std::string_view pair : kBrackets) {
    if (text.size() > 2 && text.front() == pair[0] && text.back() == pair[1]) {
      return csv_trimmed(text.substr(1, text.size() - 2));
    }
  }
  return text;
}

std::pair<std::string, std::string> split_header(std::string_view header) {
  header = csv_trimmed(header);
  std::pair<std::string, std::string> result = {std::string(header), ""};
  for (const std::string_view mark : {"[", "(", "<"}) {
    const std::size_t at = header.rfind(mark);
    if (at == std::string_view::npos || at == 0) continue;
    const std::string_view unit = without_brackets(header.substr(at));
    if (unit.size() == header.size() - at || !is_foreign_unit(unit)) continue;
    return {std::string(csv_trimmed(header.substr(0, at))), std::string(unit)};
  }
  for (const std::string_view mark : {"/", " in ", ",", "_", " "}) {
    if (take_unit_behind(header, mark, result)) return result;
  }
  return result;
}

}  // namespace abbe
