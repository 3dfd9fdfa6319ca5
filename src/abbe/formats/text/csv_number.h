#pragma once

// Internal to formats: a number in a column, from a file or from memory.
#include <cstdint>
#include <string>
#include <string_view>

#include "abbe/formats/text/csv_reader.h"

namespace abbe {

inline constexpr std::uint32_t kLargestNameCount = 1000;  // different names in a column

inline bool csv_in_range(double value, CsvColumn::Range range) {
  return range == CsvColumn::Range::any || value > 0 || (value == 0 && range == CsvColumn::Range::not_negative);
}

/// Reads a number in the unit of its column. @returns what is wrong with it, in words, or nothing
std::string csv_read_number(std::string_view field, const CsvColumn& wanted, const Unit& unit, double& value);

/// What is expected in the column: "a length in mm above zero".
std::string csv_expected_number(const CsvColumn& wanted, const Unit& unit);

}  // namespace abbe
