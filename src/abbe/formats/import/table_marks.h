#pragma once

// Internal to formats: which decimal mark the rows of a table have.
#include <cstddef>
#include <string>
#include <string_view>

#include "abbe/formats/import/table_layout.h"

namespace abbe {

/// Sets the decimal mark and the thousands mark of a layout from all rows, and says why.
/// @param columns  of the rows
/// @throws InputError as find_layout()
void find_number_marks(std::string_view text, const std::string& file, std::size_t columns, const LayoutHints& hints,
                       FoundLayout& found);

}  // namespace abbe
