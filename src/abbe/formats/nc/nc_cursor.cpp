#include "abbe/formats/nc/nc_cursor.h"

#include <algorithm>

namespace abbe {

void NcCursor::fail(const char* word, const std::string& problem, const std::string& expected) const {
  constexpr std::ptrdiff_t kLongest = 32;
  word = std::clamp(word, begin, end);
  const char* behind = std::max(word, std::min(at, end));
  while (behind != end && *behind != ' ' && *behind != '\t' && *behind != '\r') ++behind;
  std::string text(word, std::min(behind, word + std::min(kLongest, end - word)));
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < ' ' || static_cast<unsigned char>(c) > '~') c = '?';
  }
  throw InputError({*file, line, static_cast<std::size_t>(word - begin) + 1, text}, problem, expected);
}

}  // namespace abbe
