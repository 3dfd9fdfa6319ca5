#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/formats/text/named_columns.h"
#include "abbe/verify/parts/contour_sections.h"

namespace abbe {

/// Reads a CSV of sections: `section` (a name), `across`, `height`; optional `along` and `beam_tilt`, which are the
/// @param mapping  of a file whose columns have other names
/// same on all rows of a section. Sections in order of appearance. @throws InputError
std::vector<SectionReadings> read_sections(const std::filesystem::path& path, const ColumnMapping& mapping = {});
/// The same from text. @param file  name for messages
std::vector<SectionReadings> parse_sections(std::string_view text, const std::string& file,
                                            const ColumnMapping& mapping = {});
/// The same from columns in memory, named with their units as in a file. @throws InputError
std::vector<SectionReadings> parse_sections(const NamedColumns& columns);

/// The file; coordinates to a nanometre. What is optional is stated by all sections or by none.
/// @throws std::invalid_argument where only some of them state it
std::string sections_csv(const std::vector<SectionReadings>& sections);

}  // namespace abbe
