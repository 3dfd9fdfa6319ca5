#pragma once

// Internal to formats: texts of many numbers.
#include <string>

namespace abbe {

/// Appends shortest_text() to a text, without a string of its own.
void append_shortest_text(double value, int decimal_shift, std::string& out);

}  // namespace abbe
