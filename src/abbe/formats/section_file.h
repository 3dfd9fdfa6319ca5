#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace abbe {

/// One cross-section of an engraved line, as a line scanner gives it.
struct SectionReadings {
  std::string name;
  Eigen::Matrix2Xd points;          ///< [2, n] mm: across the line, out of the material; origin on the commanded curve
  std::optional<double> along;      ///< mm, where on the curve
  std::optional<double> beam_tilt;  ///< rad, of the laser's direction from the height towards across
};

/// Reads a CSV of sections: `section` (a name), `across`, `height`; optional `along` and `beam_tilt`, which are the
/// same on all rows of a section. Sections in order of appearance. @throws InputError
std::vector<SectionReadings> read_sections(const std::filesystem::path& path);
/// The same from text. @param file  name for messages
std::vector<SectionReadings> parse_sections(std::string_view text, const std::string& file);

/// The file; coordinates to a nanometre. What is optional is stated by all sections or by none.
/// @throws std::invalid_argument where only some of them state it
std::string sections_csv(const std::vector<SectionReadings>& sections);

}  // namespace abbe
