#pragma once

// Internal to formats: what the rows of a table hold, by columns.
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/formats/import/table_layout.h"

namespace abbe {

struct ColumnFacts {
  static constexpr std::size_t kMostWords = 8;
  std::string header;           ///< as written
  std::string name;             ///< of the header, without the unit
  std::string unit;             ///< of the row of units or of the header, as written; or empty
  std::size_t numbers = 0;      ///< fields that are numbers in the notation of the layout
  std::size_t sexagesimal = 0;  ///< angles in degrees, minutes and seconds
  std::size_t texts = 0;        ///< other fields
  std::size_t empty = 0;
  double smallest = 0, largest = 0;  ///< of the numbers, as written
  std::vector<std::string> words;    ///< different fields in order of appearance
  bool more_words = false;           ///< there are more than kMostWords
};

/// One pass over all rows, by all threads. @returns [columns]
std::vector<ColumnFacts> column_facts(std::string_view text, const FoundLayout& found);

}  // namespace abbe
