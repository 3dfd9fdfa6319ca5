#pragma once

#include <fmt/format.h>

#include <string_view>
#include <utility>

namespace abbe {

/// Writes to standard error. Where that is closed or full nothing is said, and the command goes on: its exit code
/// tells.
void tell_text(std::string_view text);

/// tell_text() of a format.
template <typename... Values>
void tell(fmt::format_string<Values...> format, Values&&... values) {
  tell_text(fmt::format(format, std::forward<Values>(values)...));
}

/// For the beginning of main(): opens standard streams that are closed, so that none of the files of a command gets
/// their number and what is said. Writing to them fails as before.
void keep_numbers_of_standard_streams();

}  // namespace abbe
