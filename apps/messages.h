#pragma once

#include <fmt/format.h>

#include <string_view>
#include <utility>

namespace abbe {

/// Writes to standard error. If that is closed or full, the text is lost and the command goes on; its exit code still
/// tells.
void tell_text(std::string_view text);

/// tell_text() of a format.
template <typename... Values>
void tell(fmt::format_string<Values...> format, Values&&... values) {
  tell_text(fmt::format(format, std::forward<Values>(values)...));
}

/// For the start of main(): opens /dev/null in place of closed standard streams. Otherwise a file of the command would
/// get the number of one, and messages would be written into it. Writing to such a stream still fails.
void keep_numbers_of_standard_streams();

}  // namespace abbe
