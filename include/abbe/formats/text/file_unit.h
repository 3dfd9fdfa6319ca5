#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace abbe {

/// Unit of the coordinates of a point cloud or mesh file.
enum class FileLength { millimetre, metre, inch };

/// Where the unit is known from.
enum class UnitSource {
  stated,  ///< by the file: CSV headers, PLY files with a line "comment unit mm"
  given,   ///< by the caller
  assumed  ///< mm, because STL, OBJ, XYZ and most PLY files state none; every result says so
};

struct FileUnit {
  FileLength length = FileLength::millimetre;
  UnitSource source = UnitSource::assumed;
};

/// "mm", "m", "inch".
std::string_view file_length_name(FileLength length);
std::optional<FileLength> file_length_named(std::string_view name);
/// The names of all, for options.
std::vector<std::string> file_length_names();
/// mm in one unit.
double millimetres(FileLength length);

/// The unit of a file, from what it states and what the caller says. @throws InputError if the two disagree
FileUnit agreed_unit(const std::optional<FileLength>& stated, const std::optional<FileLength>& given,
                     const std::string& file);

/// "mm (stated by the file)", "inch (as given)", "mm (assumed: the file states no unit)".
std::string unit_words(const FileUnit& unit);

}  // namespace abbe
