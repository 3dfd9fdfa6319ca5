#pragma once

// Internal to formats: whether a column of deviations is actual less target.
#include <cstddef>
#include <string_view>

#include "abbe/formats/import/foreign_unit.h"
#include "abbe/formats/import/table_layout.h"

namespace abbe {

/// Columns of a file, from 0, with their units.
struct PositionColumns {
  std::size_t target = 0, deviation = 0, actual = 0;
  const ForeignUnit* target_unit = nullptr;
  const ForeignUnit* deviation_unit = nullptr;
  const ForeignUnit* actual_unit = nullptr;
};

/// +1 if the deviations are actual less target in the rows at the beginning of a table, -1 if they are target less
/// actual, 0 if the rows do not tell, such as positions of too few digits.
int deviation_sign(std::string_view text, const FoundLayout& found, const PositionColumns& columns);

}  // namespace abbe
