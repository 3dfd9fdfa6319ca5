#pragma once

// Internal to formats: a number of a column, whether it comes as text or from a program.
#include <cstdint>
#include <string>
#include <string_view>

#include "abbe/formats/text/csv_reader.h"

namespace abbe {

inline constexpr std::uint32_t kLargestNameCount = 1000;  // of a column of names

inline bool csv_in_range(double value, CsvColumn::Range range) {
  return range == CsvColumn::Range::any || value > 0 || (value == 0 && range == CsvColumn::Range::not_negative);
}

/// Reads a number in the unit of its column. @returns what is wrong with it, in words, or nothing
std::string csv_read_number(std::string_view field, const CsvColumn& wanted, const Unit& unit, double& value);

/// What would be right: "a length in mm above zero".
std::string csv_expected_number(const CsvColumn& wanted, const Unit& unit);

}  // namespace abbe
