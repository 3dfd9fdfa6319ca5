#pragma once

// Internal to study: files in forms of instruments, as import_table() reads them.
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "abbe/formats/text/input_error.h"
#include "abbe/study/imports/imported_file.h"

namespace abbe {

/// The rows of such a file, and where they are in it.
struct InstrumentRows {
  std::string text;
  std::vector<std::size_t> lines;  ///< [rows] from 1
};

/// Reads the file if it is in a form of an instrument, and sets all of the result but its rows.
/// @returns nothing for a table; then the result is as it was
/// @throws InputError also for options that do not belong to such a file
std::optional<InstrumentRows> take_instrument(const ImportRequest& request, ImportedTable& result);

/// The same error with the line of the file in place of that of the rows; `first` is the line of the first row.
[[noreturn]] void refuse_in_file(const ImportRequest& request, const InstrumentRows& rows, const InputError& error,
                                 std::size_t first);

}  // namespace abbe
