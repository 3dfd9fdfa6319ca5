#pragma once

// Internal to formats: the XML section of an E57 file as a tree.
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace abbe {

struct E57Element {
  std::string name;  ///< of E57: "cartesianX"; of its extension for normals: "nor:normalX"; of others with their URI
  std::vector<std::pair<std::string, std::string>> attributes;
  std::string text;
  std::vector<E57Element> children;
  std::size_t line = 0;  ///< of the XML section, from 1

  /// The first child with that name, or null.
  const E57Element* child(std::string_view wanted) const;
  /// An attribute, or null.
  const std::string* attribute(std::string_view wanted) const;
};

/// @param file  name for messages
/// @return the root
/// @throws InputError
E57Element parse_e57_xml(std::string_view xml, const std::string& file);

}  // namespace abbe
