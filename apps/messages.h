#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>
#include <utility>

namespace abbe {

/// Writes to standard error what a terminal can be shown of it (abbe/formats/text/utf8.h). If standard error is closed
/// or full, the text is lost and the command goes on; its exit code still tells.
void tell_text(std::string_view text);

/// tell_text() of a format.
template <typename... Values>
void tell(fmt::format_string<Values...> format, Values&&... values) {
  tell_text(fmt::format(format, std::forward<Values>(values)...));
}

inline void tell_sentence(const std::string& sentence) { tell("abbe: {}\n", sentence); }

/// Writes to standard error as it is, for what a terminal is to obey: progress that is drawn over.
void draw(std::string_view text);

/// From now on there is no progress. @param without_text  nor what is printed on `stdout`, except by print_file()
void be_quiet(bool without_text);
bool is_quiet();

/// Prints on `stdout` what would otherwise be written to a file, also where text is not wanted.
void print_file(std::string_view contents);

/// For the start of main(): opens /dev/null in place of closed standard streams. Otherwise a file of the command would
/// get the number of one, and messages would be written into it. Writing to such a stream still fails.
void keep_numbers_of_standard_streams();

/// For the start of main(): from now on `stdout` passes on what a terminal can be shown. Names and fields come from
/// files, and whoever made these must not move the cursor, colour text or turn it round.
void make_standard_output_printable();

/// std::fflush(stdout), with what is left of text that ended within a character. @returns 0 if all of it was written
int flush_standard_output();

}  // namespace abbe
