#pragma once

#include <filesystem>
#include <initializer_list>
#include <string>
#include <string_view>

namespace abbe {

/// The extension of files that begin like these contents, even if the rest is missing: ".step", ".ply", ".stl",
/// ".pcd", ".e57", ".toml", ".csv", ".obj" or ".xyz"; empty where nothing tells.
std::string ending_of(std::string_view contents);

/// The name of a file of a shape or curve with an ending that says of what kind it is. Of standard input
/// (standard_input.h) the contents tell: "<stdin>.stl", or no ending where they do not.
std::string with_ending(const std::string& file, std::string_view contents);

/// The same, from the file. Only standard input is opened. @throws InputError as MappedFile
std::string with_ending(const std::filesystem::path& path);

/// Whether contents without a name can be an NC program: they are not of another kind, and do not begin with a word.
bool can_be_program(std::string_view contents);

/// Refuses standard input of a wrong or unknown kind, and says how files of the right kinds begin.
/// @param expected  "a mesh"
/// @param endings   of the right kinds: as above, ".abbec" or ".ngc"
/// @throws InputError
[[noreturn]] void refuse_contents(const std::string& file, std::string_view contents, std::string_view expected,
                                  std::initializer_list<std::string_view> endings);

}  // namespace abbe
