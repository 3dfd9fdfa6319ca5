#include "abbe/formats/text/unit.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <vector>

#include "abbe/geometry/angle_units.h"

namespace abbe {
namespace {

constexpr std::array<Unit, 1> kDimensionless = {{{"", 0, 1}}};
constexpr std::array<Unit, 3> kLength = {{{"mm", 0, 1}, {"um", -3, 1}, {"m", 3, 1}}};
constexpr std::array<Unit, 5> kAngle = {
    {{"rad", 0, 1}, {"mrad", -3, 1}, {"urad", -6, 1}, {"deg", 0, kDegree}, {"arcsec", 0, kArcsec}}};
constexpr std::array<Unit, 2> kLengthPerLength = {{{"mm_per_m", -3, 1}, {"um_per_m", -6, 1}}};
constexpr std::array<Unit, 4> kTime = {{{"s", 0, 1}, {"ms", -3, 1}, {"min", 0, 60}, {"h", 0, 3600}}};
constexpr std::array<Unit, 2> kLengthSquared = {{{"mm2", 0, 1}, {"um2", -6, 1}}};
constexpr std::array<Unit, 5> kAngleSquared = {{{"rad2", 0, 1},
                                                {"mrad2", -6, 1},
                                                {"urad2", -12, 1},
                                                {"deg2", 0, kDegree* kDegree},
                                                {"arcsec2", 0, kArcsec* kArcsec}}};
constexpr std::array<Unit, 4> kLengthAngle = {
    {{"mm_rad", 0, 1}, {"um_urad", -9, 1}, {"um_arcsec", -3, kArcsec}, {"mm_arcsec", 0, kArcsec}}};
constexpr std::array<Unit, 1> kTemperature = {{{"degC", 0, 1}}};
constexpr std::array<Unit, 1> kTemperatureDifference = {{{"K", 0, 1}}};
constexpr std::array<Unit, 1> kExpansion = {{{"um_per_m_K", -6, 1}}};
constexpr std::array<Unit, 1> kTemperatureRate = {{{"K_per_h", 0, 1.0 / 3600}}};
constexpr std::array<Quantity, 12> kQuantities = {Quantity::dimensionless,
                                                  Quantity::length,
                                                  Quantity::angle,
                                                  Quantity::length_per_length,
                                                  Quantity::time,
                                                  Quantity::length_squared,
                                                  Quantity::angle_squared,
                                                  Quantity::length_angle,
                                                  Quantity::temperature,
                                                  Quantity::temperature_difference,
                                                  Quantity::temperature_rate,
                                                  Quantity::expansion};

/// Edits from one spelling to the other: insert, remove, replace, exchange neighbours (1 each), change case (0.5).
double spelling_distance(std::string_view a, std::string_view b) {
  const std::size_t width = b.size() + 1;
  std::vector<double> distance((a.size() + 1) * width);
  const auto at = [&](std::size_t i, std::size_t j) -> double& { return distance[i * width + j]; };
  for (std::size_t i = 0; i <= a.size(); ++i) {
    for (std::size_t j = 0; j <= b.size(); ++j) {
      if (i == 0 || j == 0) {
        at(i, j) = static_cast<double>(i + j);
        continue;
      }
      const bool case_only = (a[i - 1] | 0x20) == (b[j - 1] | 0x20);
      const double replace = a[i - 1] == b[j - 1] ? 0 : case_only ? 0.5 : 1;
      at(i, j) = std::min({at(i - 1, j) + 1, at(i, j - 1) + 1, at(i - 1, j - 1) + replace});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        at(i, j) = std::min(at(i, j), at(i - 2, j - 2) + 1);
    }
  }
  return at(a.size(), b.size());
}

}  // namespace

std::span<const Unit> units_of(Quantity quantity) {
  switch (quantity) {
    case Quantity::dimensionless:
      return kDimensionless;
    case Quantity::length:
      return kLength;
    case Quantity::angle:
      return kAngle;
    case Quantity::length_per_length:
      return kLengthPerLength;
    case Quantity::time:
      return kTime;
    case Quantity::length_squared:
      return kLengthSquared;
    case Quantity::angle_squared:
      return kAngleSquared;
    case Quantity::length_angle:
      return kLengthAngle;
    case Quantity::temperature:
      return kTemperature;
    case Quantity::temperature_difference:
      return kTemperatureDifference;
    case Quantity::temperature_rate:
      return kTemperatureRate;
    case Quantity::expansion:
      return kExpansion;
  }
  assert(false);
  return kDimensionless;
}

std::string accepted_names(std::string_view base, Quantity quantity) {
  const auto units = units_of(quantity);
  std::string text;
  for (std::size_t i = 0; i < units.size(); ++i) {
    if (i > 0) text += i + 1 == units.size() ? " or " : ", ";
    text += base;
    if (!units[i].suffix.empty()) text.append("_").append(units[i].suffix);
  }
  return text;
}

std::string_view quantity_words(Quantity quantity) {
  switch (quantity) {
    case Quantity::dimensionless:
      return "a number";
    case Quantity::length:
      return "a length";
    case Quantity::angle:
      return "an angle";
    case Quantity::length_per_length:
      return "a length per length";
    case Quantity::time:
      return "a time";
    case Quantity::length_squared:
      return "a squared length";
    case Quantity::angle_squared:
      return "a squared angle";
    case Quantity::length_angle:
      return "a length times an angle";
    case Quantity::temperature:
      return "a temperature";
    case Quantity::temperature_difference:
      return "a temperature difference";
    case Quantity::temperature_rate:
      return "a rate of change of a temperature";
    case Quantity::expansion:
      return "a coefficient of expansion";
  }
  assert(false);
  return "";
}

const Unit* unit_of_name(std::string_view name, std::string_view base, Quantity quantity) {
  if (!name.starts_with(base)) return nullptr;
  name.remove_prefix(base.size());
  for (const Unit& unit : units_of(quantity)) {
    if (unit.suffix.empty()
            ? name.empty()
            : name.size() == unit.suffix.size() + 1 && name[0] == '_' && name.substr(1) == unit.suffix) {
      return &unit;
    }
  }
  return nullptr;
}

NumberProblem parse_quantity(std::string_view text, const Unit& unit, double& value) {
  const NumberProblem problem = parse_number(text, unit.decimal_shift, value);
  if (problem != NumberProblem::none) return problem;
  value *= unit.factor;
  return std::abs(value) > kLargestInput ? NumberProblem::too_large : NumberProblem::none;
}

std::string quantity_text(double value, const Unit& unit) {
  if (unit.factor == 1) return shortest_text(value, -unit.decimal_shift);
  return shortest_text(value / unit.factor, -unit.decimal_shift);
}

const Unit& unit_named(Quantity quantity, std::string_view suffix) {
  for (const Unit& unit : units_of(quantity)) {
    if (unit.suffix == suffix) return unit;
  }
  assert(false);
  return units_of(quantity)[0];
}

std::string_view without_unit(std::string_view name) {
  std::string_view shortest = name;
  for (const Quantity quantity : kQuantities) {
    for (const Unit& unit : units_of(quantity)) {
      const std::size_t length = unit.suffix.size() + 1;
      if (unit.suffix.empty() || name.size() <= length || !name.ends_with(unit.suffix)) continue;
      if (name[name.size() - length] != '_' || name.size() - length >= shortest.size()) continue;
      shortest = name.substr(0, name.size() - length);
    }
  }
  return shortest;
}

std::string_view nearest_name(std::string_view name, std::span<const std::string> candidates) {
  std::string_view nearest;
  double smallest = 1e9;
  if (name.size() > 100) return nearest;
  for (const std::string& candidate : candidates) {
    const double distance = spelling_distance(name, candidate);
    const auto shorter = static_cast<double>(std::min(name.size(), candidate.size()));
    const double allowed = shorter <= 2 ? 0.5 : std::max(1.0, shorter / 3);
    if (distance <= allowed && distance < smallest) {
      smallest = distance;
      nearest = candidate;
    }
  }
  return nearest;
}

}  // namespace abbe
