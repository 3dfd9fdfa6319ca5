#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace abbe {

/// The name of a file of a shape or curve with an ending that says of what kind it is. Of standard input
/// (standard_input.h) the contents tell: "<stdin>.stl", .step, .ply, .obj, .csv or .xyz, or no ending where they do
/// not.
std::string with_ending(const std::string& file, std::string_view contents);

/// The same, from the file. Only standard input is opened. @throws InputError as MappedFile
std::string with_ending(const std::filesystem::path& path);

}  // namespace abbe
