#include "abbe/report/customer/xml_writer.h"

#include <cassert>

#include "abbe/report/drawings/svg_drawing.h"

namespace abbe {
void XmlWriter::begin(const std::string& name, const Attributes& attributes) {
  text_ += std::string(2 * open_.size(), ' ') + "<" + name;
  for (const auto& [key, value] : attributes) text_ += " " + key + "=\"" + xml_text(value) + "\"";
  text_ += ">";
}

void XmlWriter::open(const std::string& name, const Attributes& attributes) {
  begin(name, attributes);
  text_ += "\n";
  open_.push_back(name);
}

void XmlWriter::close() {
  assert(!open_.empty());
  const std::string name = open_.back();
  open_.pop_back();
  text_ += std::string(2 * open_.size(), ' ') + "</" + name + ">\n";
}

void XmlWriter::element(const std::string& name, std::string_view text, const Attributes& attributes) {
  begin(name, attributes);
  text_ += xml_text(text) + "</" + name + ">\n";
}

std::string XmlWriter::document() const {
  assert(open_.empty());
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n" + text_;
}

}  // namespace abbe
