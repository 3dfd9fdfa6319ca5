#include "abbe/formats/shapes/ending.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "abbe/formats/files/standard_input.h"
#include "abbe/formats/files/text_file.h"
#include "abbe/formats/shapes/e57_file.h"
#include "abbe/formats/shapes/pcd_header.h"
#include "abbe/formats/shapes/ply_file.h"
#include "abbe/formats/shapes/step_file.h"
#include "abbe/formats/shapes/stl_file.h"
#include "abbe/formats/text/ascii_letters.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/text_cursor.h"

namespace abbe {
namespace {

/// A kind of file, for messages.
struct ContentsKind {
  std::string_view ending, name, beginning;
};

constexpr std::array<ContentsKind, 11> kContentsKinds = {
    {{".toml", "a machine file", "'name = ...'"},
     {".abbec", "a frozen compensation", "byte 0x89, 'ABBEC'"},
     {".stl", "an STL file", "'solid', or 80 bytes and the number of triangles"},
     {".ply", "a PLY file", "'ply'"},
     {".pcd", "a PCD file", "'# .PCD'"},
     {".e57", "an E57 file", "'ASTM-E57'"},
     {".obj", "an OBJ file", "'v X Y Z'"},
     {".step", "a STEP file", "'ISO-10303-21;'"},
     {".csv", "a CSV file", "'x_mm,y_mm,z_mm'"},
     {".xyz", "an XYZ file", "numbers"},
     {".ngc", "an NC program", "a letter and a number, '%' or a comment"}}};

const ContentsKind* kind_named(std::string_view ending) {
  const auto* const kind = std::find_if(kContentsKinds.begin(), kContentsKinds.end(),
                                        [&](const ContentsKind& one) { return one.ending == ending; });
  return kind == kContentsKinds.end() ? nullptr : kind;
}

/// First line that is neither empty nor a comment, from its first letter.
std::string_view first_line(std::string_view contents) {
  if (contents.starts_with("\xEF\xBB\xBF")) contents.remove_prefix(3);
  const std::string name;
  for (TextCursor cursor(contents, name); !cursor.at_end();) {
    std::string_view line = cursor.line();
    while (!line.empty() && is_blank(line.front())) line.remove_prefix(1);
    if (!line.empty() && line.front() != '#' && !line.starts_with("//")) return line;
  }
  return {};
}

/// [a.table] or a key before '='.
bool is_toml(std::string_view line) {
  if (line.starts_with('[')) return line.size() > 1 && (is_letter(line[1]) || line[1] == '[' || line[1] == '"');
  const std::size_t equals = line.find('=');
  if (equals == std::string_view::npos) return false;
  std::string_view key = line.substr(0, equals);
  while (!key.empty() && is_blank(key.back())) key.remove_suffix(1);
  return !key.empty() && std::all_of(key.begin(), key.end(), [](char c) {
    return is_letter(c) || is_digit(c) || c == '_' || c == '-' || c == '.' || c == '"';
  });
}

bool is_csv(std::string_view line) {
  return line.find("x_") != std::string_view::npos || line.starts_with("x,") || line.starts_with("x;");
}

bool is_obj(std::string_view word) {
  constexpr std::array<std::string_view, 10> kWords = {"v", "vn", "vt", "f", "l", "o", "g", "mtllib", "usemtl", "s"};
  return std::find(kWords.begin(), kWords.end(), word) != kWords.end();
}

bool is_xyz(std::string_view word) {
  return !word.empty() &&
         (is_digit(word.front()) || word.front() == '-' || word.front() == '+' || word.front() == '.') &&
         word.find_first_not_of("+-.,;0123456789eE") == std::string_view::npos;
}

}  // namespace

std::string ending_of(std::string_view contents) {
  // Files that were cut short are of their kind too: what is missing is then said.
  if (is_step(contents) || contents.starts_with("ISO-10303")) return ".step";
  if (is_ply(contents)) return ".ply";
  if (is_e57(contents)) return ".e57";
  if (is_pcd(contents)) return ".pcd";
  if (is_binary_stl(contents) || is_ascii_stl(contents) || begins_like_binary_stl(contents)) return ".stl";
  const std::string_view line = first_line(contents);
  if (is_toml(line)) return ".toml";
  if (is_csv(line)) return ".csv";
  const std::string_view word = line.substr(0, line.find_first_of(" \t\r"));
  if (is_obj(word)) return ".obj";
  return is_xyz(word) ? ".xyz" : "";
}

std::string with_ending(const std::string& file, std::string_view contents) {
  return file == kStandardInput ? file + ending_of(contents) : file;
}

std::string with_ending(const std::filesystem::path& path) {
  return path == kStandardInput ? with_ending(path.string(), MappedFile(path).text()) : path.string();
}

bool can_be_program(std::string_view contents) {
  const std::string ending = ending_of(contents);
  for (const char* const other : {".step", ".ply", ".stl", ".pcd", ".e57", ".xyz"}) {
    if (ending == other) return false;
  }
  const std::string_view line = first_line(contents);
  if (line.find('\0') != std::string_view::npos || line.starts_with('[')) return false;
  // One letter of a mistyped word is no reason to look no further; three make a word of a text.
  return !(line.size() >= 3 && std::all_of(line.begin(), line.begin() + 3, is_letter));
}

void refuse_contents(const std::string& file, std::string_view contents, std::string_view expected,
                     std::initializer_list<std::string_view> endings) {
  const ContentsKind* const found = kind_named(ending_of(contents));
  std::string list;
  for (const std::string_view& ending : endings) {
    const ContentsKind* const kind = kind_named(ending);
    const bool is_last = &ending + 1 == endings.end();
    list += fmt::format("{}{} ({})", list.empty() ? "" : is_last ? " or " : ", ", kind->name, kind->beginning);
  }
  throw InputError({.file = file},
                   found == nullptr ? std::string("its kind cannot be recognised from its contents")
                                    : fmt::format("begins like {}", found->name),
                   fmt::format("{} that begins like {}; or give the name of a file, whose extension shows its kind",
                               expected, list));
}

}  // namespace abbe
