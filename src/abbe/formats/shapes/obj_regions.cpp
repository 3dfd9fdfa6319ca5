#include "abbe/formats/shapes/obj_regions.h"

#include <algorithm>

namespace abbe {
namespace {

/// Bytes of a name that are kept, so that the list of all combinations cannot become much larger than the file.
constexpr std::size_t kKept = 60;

/// Never half of a character of UTF-8, and nothing that moves a terminal's cursor.
std::string kept(std::string_view name) {
  std::size_t length = std::min(name.size(), kKept);
  while (length > 0 && length < name.size() && (static_cast<unsigned char>(name[length]) & 0xc0U) == 0x80U) --length;
  std::string text(name.substr(0, length));
  std::replace_if(
      text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20U || c == '\x7f'; }, '.');
  return text;
}

}  // namespace

void ObjRegions::append(std::size_t triangles) {
  if (triangles == 0) return;
  const auto [place, is_new] = regions_.emplace(current_, static_cast<std::uint32_t>(names.size()));
  if (is_new) {
    std::string name;
    for (std::size_t k = 0; k < current_.size(); ++k) {
      const std::string part = current_[k] == kNone ? "" : kept(current_names_[k]);
      if (!name.empty() && !part.empty()) name += " / ";
      name += part;
    }
    names.push_back(name.empty() ? "unnamed" : name);
  }
  region_of_triangle.insert(region_of_triangle.end(), triangles, place->second);
}

void ObjRegions::add(const std::vector<ObjStatement>& statements, std::size_t triangles) {
  std::size_t done = 0;
  for (const ObjStatement& statement : statements) {
    append(statement.triangles - done);
    done = statement.triangles;
    any_statement_ = true;
    current_names_[statement.scope] = statement.name;
    // Without a name it ends what was stated before.
    current_[statement.scope] =
        statement.name.empty()
            ? kNone
            : words_.emplace(statement.name, static_cast<std::uint32_t>(words_.size())).first->second;
  }
  append(triangles - done);
}

}  // namespace abbe
