#pragma once

// Internal to formats: what readers of XML forms of instruments share.
#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/formats/text/xml_tree.h"

namespace abbe {

/// Whether a document begins with that element, whatever its prefix, behind comments and instructions.
bool begins_with_element(std::string_view text, std::string_view name);

/// The root of a document, with names without their URIs. @throws InputError that says what was expected
XmlElement instrument_xml(std::string_view text, const std::string& file, const std::string& expected);

/// The element at the end of a path of children, or null.
const XmlElement* xml_at(const XmlElement& root, const std::vector<std::string_view>& path);
/// Text of the element at the end of a path, without blanks around it; empty if there is none.
std::string xml_text_at(const XmlElement& root, const std::vector<std::string_view>& path);
/// Value of an attribute; empty if there is none.
std::string xml_attribute(const XmlElement& element, std::string_view name);

/// A number in the text of an element, and its line.
struct XmlNumber {
  std::string_view text;
  std::size_t line = 0;
};
/// All of them. @throws InputError for what is no number
std::vector<XmlNumber> xml_numbers(const XmlElement& element, const std::string& file, const std::string& field,
                                   const std::string& expected);

/// "Position (120), Temperature" of how often each name was there, as parts for lists of what was not read.
std::vector<std::string> counted_names(const std::map<std::string, std::size_t>& counts);

}  // namespace abbe
