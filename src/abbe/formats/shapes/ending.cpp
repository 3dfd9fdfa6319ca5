#include "abbe/formats/shapes/ending.h"

#include <algorithm>
#include <array>

#include "abbe/formats/files/standard_input.h"
#include "abbe/formats/files/text_file.h"
#include "abbe/formats/shapes/ply_file.h"
#include "abbe/formats/shapes/step_file.h"
#include "abbe/formats/shapes/stl_file.h"
#include "abbe/formats/text/text_cursor.h"

namespace abbe {
namespace {

/// First line that is neither empty nor a comment, from its first letter.
std::string_view first_line(std::string_view contents) {
  const std::string name;
  for (TextCursor cursor(contents, name); !cursor.at_end();) {
    std::string_view line = cursor.line();
    while (!line.empty() && is_blank(line.front())) line.remove_prefix(1);
    if (!line.empty() && line.front() != '#' && !line.starts_with("//")) return line;
  }
  return {};
}

const char* ending_of(std::string_view contents) {
  if (is_step(contents)) return ".step";
  if (is_ply(contents)) return ".ply";
  if (is_binary_stl(contents) || is_ascii_stl(contents)) return ".stl";
  const std::string_view line = first_line(contents);
  if (line.find("x_") != std::string_view::npos) return ".csv";
  constexpr std::array<std::string_view, 10> kObjWords = {"v", "vn", "vt", "f", "l", "o", "g", "mtllib", "usemtl", "s"};
  const std::string_view word = line.substr(0, line.find_first_of(" \t\r"));
  if (std::find(kObjWords.begin(), kObjWords.end(), word) != kObjWords.end()) return ".obj";
  return !word.empty() && word.find_first_not_of("+-.,;0123456789eE") == std::string_view::npos ? ".xyz" : "";
}

}  // namespace

std::string with_ending(const std::string& file, std::string_view contents) {
  return file == kStandardInput ? file + ending_of(contents) : file;
}

std::string with_ending(const std::filesystem::path& path) {
  return path == kStandardInput ? with_ending(path.string(), MappedFile(path).text()) : path.string();
}

}  // namespace abbe
