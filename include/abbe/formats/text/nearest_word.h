#pragma once

#include <optional>
#include <string>
#include <vector>

namespace abbe {

/// Number of letters to insert, remove, replace or swap with their neighbour to make one word of the other
/// (optimal string alignment).
std::size_t spelling_distance(const std::string& one, const std::string& other);

/// The word of a list that somebody may have meant who wrote this one: the nearest, if no more than a third of its
/// letters differ and it is nearer than all others.
std::optional<std::string> nearest_word(const std::string& written, const std::vector<std::string>& words);

}  // namespace abbe
