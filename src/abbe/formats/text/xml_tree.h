#pragma once

// Internal to formats: an XML document as a tree.
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace abbe {

struct XmlElement {
  std::string name;
  std::vector<std::pair<std::string, std::string>> attributes;
  std::string text;  ///< of its own, without that of its children
  std::vector<XmlElement> children;
  std::size_t line = 0;  ///< where it begins, from 1

  /// The first child with that name, or null.
  const XmlElement* child(std::string_view wanted) const;
  /// An attribute, or null.
  const std::string* attribute(std::string_view wanted) const;
};

/// What is wrong with a document.
struct XmlProblem {
  std::size_t line = 0, column = 0;  ///< from 1
  std::string words;
};

struct XmlTree {
  XmlElement root;
  std::optional<XmlProblem> problem;  ///< then there is no root
};

/// What stands between the URI and the local name of the names that `plain_name` is given.
inline constexpr char kBehindXmlUri = '|';

/// Reads a document. One with a DOCTYPE, which might define entities, or with more than 100 levels is refused.
/// @param plain_name  what elements are called, from their names with URIs
/// @param encoding    of the bytes, whatever the document says; null: as it says
XmlTree parse_xml(std::string_view xml, std::string (*plain_name)(std::string_view), const char* encoding = nullptr);

/// Without the blanks of XML around it: space, tab, line feed, carriage return.
std::string_view xml_trimmed(std::string_view text);

/// The name without its URI.
std::string local_xml_name(std::string_view name);

}  // namespace abbe
