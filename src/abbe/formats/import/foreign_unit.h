#pragma once

// Internal to formats: units as other programs call them.
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "abbe/formats/text/unit.h"

namespace abbe {

/// A unit and how its numbers become numbers of one that Abbe reads: number * factor * 10^shift, exact in decimal.
struct ForeignUnit {
  std::string_view name;  ///< as in mapping files: "inch"
  Quantity quantity = Quantity::length;
  std::string_view suffix;  ///< of the unit that Abbe reads: "mm"
  std::uint32_t factor = 1;
  int shift = 0;
  bool sexagesimal = false;  ///< degrees, minutes and seconds in one field
};

/// A number in a unit, in the inside unit of its quantity; rounded.
double inside_number(const ForeignUnit& unit, double number);

/// The unit of that name, of a mapping file; null if there is none.
const ForeignUnit* foreign_unit_named(std::string_view name);
/// The names of all units of a quantity.
std::vector<std::string_view> foreign_unit_names(Quantity quantity);

/// The unit that another program writes so: "Zoll", "µm", "[deg]" without its brackets; null if none of the quantity
/// is.
const ForeignUnit* foreign_unit(std::string_view written, Quantity quantity);
/// Whether any quantity has a unit that is written so.
bool is_foreign_unit(std::string_view written);

/// "mm" of "[mm]", "(mm)" or "<mm>".
std::string_view without_brackets(std::string_view text);

/// Name and unit of a header field: "X [mm]", "X (mm)", "X/mm", "X in mm", "X, mm", "x_mm", "X mm". The unit is empty
/// where what stands there is none.
std::pair<std::string, std::string> split_header(std::string_view header);

}  // namespace abbe
