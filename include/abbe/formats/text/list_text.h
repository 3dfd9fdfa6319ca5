#pragma once

// For formats and the programs: counts and lists in messages.
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace abbe {

/// The number and what there is of it: "1 face is", "3 faces are".
std::string counted(std::size_t count, const char* one, const char* more);

/// The first five texts, and how many follow: "a; b; c; d; e; and 2 more".
std::string first_few(const std::vector<std::string>& texts, std::string_view between);

}  // namespace abbe
