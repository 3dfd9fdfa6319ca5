#include "abbe/formats/text/nearest_word.h"

#include <algorithm>

namespace abbe {

std::size_t spelling_distance(const std::string& one, const std::string& other) {
  const std::size_t rows = one.size() + 1, columns = other.size() + 1;
  std::vector<std::size_t> distance(rows * columns);
  const auto at = [&](std::size_t i, std::size_t j) -> std::size_t& { return distance[i * columns + j]; };
  for (std::size_t i = 0; i < rows; ++i) at(i, 0) = i;
  for (std::size_t j = 0; j < columns; ++j) at(0, j) = j;
  for (std::size_t i = 1; i < rows; ++i) {
    for (std::size_t j = 1; j < columns; ++j) {
      const std::size_t replaced = at(i - 1, j - 1) + (one[i - 1] == other[j - 1] ? 0 : 1);
      at(i, j) = std::min({at(i - 1, j) + 1, at(i, j - 1) + 1, replaced});
      if (i > 1 && j > 1 && one[i - 1] == other[j - 2] && one[i - 2] == other[j - 1]) {
        at(i, j) = std::min(at(i, j), at(i - 2, j - 2) + 1);
      }
    }
  }
  return at(rows - 1, columns - 1);
}

std::optional<std::string> nearest_word(const std::string& written, const std::vector<std::string>& words) {
  std::optional<std::string> nearest;
  std::size_t least = 0;
  bool alone = false;
  for (const std::string& word : words) {
    const std::size_t distance = spelling_distance(written, word);
    if (3 * distance > std::max(written.size(), word.size())) continue;
    if (nearest && distance > least) continue;
    alone = !nearest || distance < least;
    nearest = word;
    least = distance;
  }
  return alone ? nearest : std::nullopt;
}

}  // namespace abbe
