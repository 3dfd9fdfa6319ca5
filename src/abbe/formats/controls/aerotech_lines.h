#pragma once

// Internal to formats: what the calibration files of Aerotech have in common.
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/formats/controls/table_axis_names.h"
#include "abbe/formats/text/table_numbers.h"

namespace abbe {

/// What a line without its comment is.
struct AerotechLine {
  enum class Kind { start, end, numbers } kind = Kind::numbers;
  std::vector<std::string> words;  ///< behind :START, "=" being a word; else numbers
};
/// The next line that is not empty.
/// @param start  ":START" or ":START2D"
/// @returns false at the end  @throws InputError for other words with a colon
bool next_aerotech_line(TableLines& lines, std::string_view start, AerotechLine& found);

/// A word KEY=VALUE or KEY of a line with :START; keys are upper case, the value of a key alone is null.
using AerotechKey = std::function<void(const std::string& key, const std::string* value)>;
/// @param first  word to begin with
void read_aerotech_keys(const AerotechLine& line, std::size_t first, const AerotechKey& read);

/// "PRIMARY/1000": how many of the file's units are one of the axis. @throws InputError
struct AerotechUnit {
  double per_unit = 1;
  bool millimetres = false;  ///< METRIC: not for rotary axes
  bool given = false;        ///< in the file
};
AerotechUnit aerotech_unit(const TableLines& lines, const std::string& field, const std::string* word);

/// The value of a key that has to have one. @throws InputError
const std::string& aerotech_value(const TableLines& lines, const std::string& field, const std::string* word);
const TableAxisName* aerotech_axis(const TableLines& lines, const std::string& field, std::string_view name,
                                   const std::vector<TableAxisName>& axes);

/// Evenly spaced positions, increasing; mm or rad. A step below zero counts downwards, and the values with it.
/// @param offset  the first is at -offset
std::vector<double> aerotech_positions(double step, double offset, std::size_t count, double per_unit, bool rotary);

}  // namespace abbe
