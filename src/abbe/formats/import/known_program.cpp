#include "abbe/formats/import/known_program.h"

#include <algorithm>
#include <array>
#include <string>

#include "abbe/formats/import/foreign_word.h"

namespace abbe {
namespace {

/// "A::grp::p1": collection, group and point of SpatialAnalyzer.
bool has_name_of_three(std::string_view text) {
  for (std::size_t at = text.find("::"); at != std::string_view::npos; at = text.find("::", at + 1)) {
    const std::size_t second = text.find("::", at + 2);
    const std::size_t end = text.find_first_of("\r\n", at);
    if (second != std::string_view::npos && second > at + 2 && second < std::min(end, text.size())) return true;
  }
  return false;
}

bool has_any(const std::string& text, std::initializer_list<const char*> words) {
  return std::any_of(words.begin(), words.end(),
                     [&](const char* word) { return text.find(word) != std::string::npos; });
}

}  // namespace

std::optional<KnownProgram> known_program(std::string_view text) {
  constexpr std::size_t kLookedAtOfProgram = 4096;
  text = text.substr(0, kLookedAtOfProgram);
  if (has_name_of_three(text)) {
    return KnownProgram{"its names are those of a point list of SpatialAnalyzer, collection::group::point",
                        "Cartesian coordinates, which are read with --as points; or a line above them with the names "
                        "of the columns and their units"};
  }
  const std::string small = small_letters(text);
  if (has_any(small, {"metrolog"})) {
    return KnownProgram{"it is a report of Metrolog, which has no public description",
                        "the points as a table: a line of names (Name, X, Y, Z), their units and one line for each "
                        "point"};
  }
  if (has_any(small, {"sinumerik", "measuring cycle", "messzyklus", "messzyklen", "_ovr["})) {
    return KnownProgram{"it is a protocol of measuring cycles of Siemens, whose columns each program chooses",
                        "a protocol with one line for each measurement below a line of names of its columns"};
  }
  return std::nullopt;
}

}  // namespace abbe
