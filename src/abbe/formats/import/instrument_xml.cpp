#include "abbe/formats/import/instrument_xml.h"

#include <fmt/format.h>

#include "abbe/formats/import/instrument_lines.h"
#include "abbe/formats/text/csv_header.h"
#include "abbe/formats/text/input_error.h"

namespace abbe {

bool begins_with_element(std::string_view text, std::string_view name) {
  constexpr std::size_t kLookedAtOfXml = std::size_t{1} << 16U;
  text = text.substr(0, kLookedAtOfXml);
  for (;;) {
    const std::size_t at = text.find_first_not_of(" \t\r\n");
    if (at == std::string_view::npos || text[at] != '<') return false;
    text.remove_prefix(at);
    if (!text.starts_with("<?") && !text.starts_with("<!--")) break;
    const std::string_view end = text.starts_with("<?") ? "?>" : "-->";
    const std::size_t behind = text.find(end);
    if (behind == std::string_view::npos) return false;
    text.remove_prefix(behind + end.size());
  }
  std::string_view tag = text.substr(1, text.find_first_of(" \t\r\n/>") - 1);
  const std::size_t colon = tag.find(':');
  if (colon != std::string_view::npos) tag.remove_prefix(colon + 1);
  return tag == name;
}

XmlElement instrument_xml(std::string_view text, const std::string& file, const std::string& expected) {
  // The text is UTF-8 by now, whatever the document says of its bytes.
  XmlTree tree = parse_xml(text, local_xml_name, "UTF-8");
  if (tree.problem) {
    throw InputError({.file = file, .line = tree.problem->line, .column = tree.problem->column}, tree.problem->words,
                     expected);
  }
  return std::move(tree.root);
}

const XmlElement* xml_at(const XmlElement& root, const std::vector<std::string_view>& path) {
  const XmlElement* element = &root;
  for (const std::string_view name : path) {
    if (element != nullptr) element = element->child(name);
  }
  return element;
}

std::string xml_text_at(const XmlElement& root, const std::vector<std::string_view>& path) {
  const XmlElement* const element = xml_at(root, path);
  if (element == nullptr) return "";
  return std::string(xml_trimmed(element->text));
}

std::string xml_attribute(const XmlElement& element, std::string_view name) {
  const std::string* const value = element.attribute(name);
  return value == nullptr ? "" : *value;
}

std::vector<XmlNumber> xml_numbers(const XmlElement& element, const std::string& file, const std::string& field,
                                   const std::string& expected) {
  std::vector<XmlNumber> numbers;
  const std::string_view text = element.text;
  std::size_t line = element.line;
  for (std::size_t at = 0; at < text.size();) {
    const std::string_view row = csv_next_line(text, at);
    for (const std::string_view word : instrument_words(row)) {
      instrument_number(word, file, line, field, expected);
      numbers.push_back({word, line});
    }
    ++line;
  }
  return numbers;
}

std::vector<std::string> counted_names(const std::map<std::string, std::size_t>& counts) {
  std::vector<std::string> names;
  for (const auto& [name, count] : counts) {
    names.push_back(count == 1 ? shown_text(name) : fmt::format("{} ({})", shown_text(name), count));
  }
  return names;
}

}  // namespace abbe
