#pragma once

#include <span>
#include <string>
#include <string_view>

#include "abbe/formats/text/number_text.h"

namespace abbe {

/// What a number in a file measures; decides which unit suffixes its name may have.
enum class Quantity {
  dimensionless,           ///< no suffix
  length,                  ///< inside mm
  angle,                   ///< inside rad
  length_per_length,       ///< inside mm per mm; a noise growing with distance
  time,                    ///< inside s
  length_squared,          ///< inside mm^2
  angle_squared,           ///< inside rad^2
  length_angle,            ///< inside mm rad; a covariance of a length and an angle
  temperature,             ///< inside degC
  temperature_difference,  ///< inside K
  temperature_rate,        ///< inside K/s
  expansion,               ///< inside 1/K; coefficient of thermal expansion
};

/// A unit as written at the end of a name: inside value = text * 10^decimal_shift * factor.
struct Unit {
  std::string_view suffix;  ///< "mm", "um_per_m", ""
  int decimal_shift = 0;
  double factor = 1;
};

/// The units accepted for a quantity, the inside one first.
std::span<const Unit> units_of(Quantity quantity);

/// "travel" with Quantity::length: "travel_mm, travel_um or travel_m".
std::string accepted_names(std::string_view base, Quantity quantity);

/// "a length", "an angle", ...
std::string_view quantity_words(Quantity quantity);

/// Unit of a name "<base>_<suffix>", or null if the name is not the base with a unit of that quantity.
const Unit* unit_of_name(std::string_view name, std::string_view base, Quantity quantity);

/// Value of text in a unit, in the inside unit; see parse_number(). Magnitudes over kLargestInput are too_large.
NumberProblem parse_quantity(std::string_view text, const Unit& unit, double& value);

/// Shortest text of a value in a unit: exact for decimal units (factor 1), else to one unit in the last place.
std::string quantity_text(double value, const Unit& unit);

/// The unit of that suffix; asserts that there is one.
const Unit& unit_named(Quantity quantity, std::string_view suffix);

/// "range" of "range_um_per_m"; the name itself if it does not end in "_" and a unit of any quantity.
std::string_view without_unit(std::string_view name);

/// The candidate nearest in spelling, or empty if none is near.
std::string_view nearest_name(std::string_view name, std::span<const std::string> candidates);

}  // namespace abbe
