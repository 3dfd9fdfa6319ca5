#pragma once

#include <string>
#include <string_view>

namespace abbe {

/// Style sheet of a customer report for sheets of size A4, with the number of the sheet at its foot.
/// @param foot  shown beside that number: any text
std::string customer_style(std::string_view foot);

/// A text in quotes as style sheets take it: all but ASCII letters, digits and spaces as escapes.
std::string style_string(std::string_view text);

}  // namespace abbe
