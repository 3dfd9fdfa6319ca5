#pragma once

namespace abbe {

/// The text of column_rows.py.
extern const char* const kColumnRowsProgram;

}  // namespace abbe
