#pragma once

// Internal to formats: the XML section of an E57 file as a tree.
#include <string>
#include <string_view>

#include "abbe/formats/text/xml_tree.h"

namespace abbe {

/// Its name is that of E57, "cartesianX", of its extension for normals, "nor:normalX", or of others with their URI; its
/// line is that of the XML section.
using E57Element = XmlElement;

/// @param file  name for messages
/// @return the root
/// @throws InputError
E57Element parse_e57_xml(std::string_view xml, const std::string& file);

}  // namespace abbe
