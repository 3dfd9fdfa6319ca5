#pragma once

#include <string>

#include "reproduce_output.h"

namespace abbe {

/// A cell as people read it. A number too small for its decimals has one significant digit: "3e-12".
std::string cell_text(const ReproducedCell& cell, const ReproducedColumn& column);

/// A table with its title and notes. Columns of texts are flush left, numbers flush right; a last column of texts is
/// wrapped.
std::string table_text(const ReproducedTable& table);

}  // namespace abbe
