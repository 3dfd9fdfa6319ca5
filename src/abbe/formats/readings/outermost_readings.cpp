#include "abbe/formats/readings/outermost_readings.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "abbe/geometry/numbered_work.h"

namespace abbe {

void OutermostReadings::Ends::take(const Ends& other) {
  least = std::min(least, other.least);
  // Of equal ones the first.
  if (other.largest.first > largest.first ||
      (!(other.largest.first < largest.first) && other.largest.second < largest.second)) {
    largest = other.largest;
  }
}

void OutermostReadings::take(std::size_t column, const Ends& ends) {
  const auto [place, is_new] = columns_.try_emplace(column, ends);
  if (!is_new) place->second.take(ends);
}

template <typename Values>
void OutermostReadings::take_column(std::size_t column, const Values& values, std::size_t first) {
  for (std::size_t k = 0; k < values.size(); ++k) {
    const double value = static_cast<double>(values[k]);
    if (!std::isnan(value)) take(column, Ends{{value, first + k}, {value, first + k}});
  }
}

void OutermostReadings::take(const InstrumentReadings& readings, std::size_t first) {
  std::size_t column = 0;
  const auto take_columns = [&](const auto& columns) {
    for (const auto& values : columns) take_column(column++, values, first);
  };
  take_columns(readings.poses.axis);
  take_columns(readings.poses.approach);
  take_columns(readings.poses.state);
  take_columns(readings.inputs);
  for (std::size_t k = 0; k < readings.item.size(); ++k) {
    const auto [place, is_new] = items_.try_emplace(readings.item[k], first + k);
    if (!is_new) place->second = std::min(place->second, first + k);
  }
}

void OutermostReadings::take(const OutermostReadings& others) {
  for (const auto& [column, ends] : others.columns_) take(column, ends);
  for (const auto& [item, reading] : others.items_) {
    const auto [place, is_new] = items_.try_emplace(item, reading);
    if (!is_new) place->second = std::min(place->second, reading);
  }
}

std::vector<std::size_t> OutermostReadings::readings() const {
  std::vector<std::size_t> result;
  for (const auto& [column, ends] : columns_) {
    result.push_back(ends.least.second);
    result.push_back(ends.largest.second);
  }
  for (const auto& [item, reading] : items_) result.push_back(reading);
  std::sort(result.begin(), result.end());
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

// Numbers of readings are below 2^53, so a double holds them.
void OutermostReadings::pack(std::vector<std::byte>& bytes) const {
  std::vector<double> numbers{static_cast<double>(columns_.size()), static_cast<double>(items_.size())};
  for (const auto& [column, ends] : columns_) {
    numbers.insert(numbers.end(),
                   {static_cast<double>(column), ends.least.first, static_cast<double>(ends.least.second),
                    ends.largest.first, static_cast<double>(ends.largest.second)});
  }
  for (const auto& [item, reading] : items_) {
    numbers.insert(numbers.end(), {static_cast<double>(item), static_cast<double>(reading)});
  }
  pack_numbers(numbers, bytes);
}

OutermostReadings OutermostReadings::unpack(std::span<const std::byte>& bytes) {
  OutermostReadings result;
  std::array<double, 2> counts{};
  unpack_numbers(bytes, counts);
  const auto number = [](double value) {
    if (!(value >= 0 && value < 0x1p53)) throw WorkError("a number of a reading is none");
    return static_cast<std::size_t>(value);
  };
  for (std::size_t k = number(counts[0]); k > 0; --k) {
    std::array<double, 5> n{};
    unpack_numbers(bytes, n);
    result.columns_[number(n[0])] = {{n[1], number(n[2])}, {n[3], number(n[4])}};
  }
  for (std::size_t k = number(counts[1]); k > 0; --k) {
    std::array<double, 2> n{};
    unpack_numbers(bytes, n);
    result.items_[static_cast<std::uint16_t>(number(n[0]))] = number(n[1]);
  }
  return result;
}

}  // namespace abbe
