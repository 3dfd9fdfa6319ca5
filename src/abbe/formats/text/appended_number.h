#pragma once

// Internal to formats: texts of many numbers.
#include <string>

namespace abbe {

/// shortest_text() behind a text that is there already, which is quicker.
void append_shortest_text(double value, int decimal_shift, std::string& out);

}  // namespace abbe
