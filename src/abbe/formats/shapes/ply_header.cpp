#include "abbe/formats/shapes/ply_header.h"

#include <fmt/format.h>

#include <array>
#include <utility>

#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/text_cursor.h"

namespace abbe {
namespace {

constexpr std::array<std::pair<std::string_view, PlyType>, 16> kTypes = {{{"char", PlyType::int8},
                                                                          {"uchar", PlyType::uint8},
                                                                          {"short", PlyType::int16},
                                                                          {"ushort", PlyType::uint16},
                                                                          {"int", PlyType::int32},
                                                                          {"uint", PlyType::uint32},
                                                                          {"float", PlyType::float32},
                                                                          {"double", PlyType::float64},
                                                                          {"int8", PlyType::int8},
                                                                          {"uint8", PlyType::uint8},
                                                                          {"int16", PlyType::int16},
                                                                          {"uint16", PlyType::uint16},
                                                                          {"int32", PlyType::int32},
                                                                          {"uint32", PlyType::uint32},
                                                                          {"float32", PlyType::float32},
                                                                          {"float64", PlyType::float64}}};
// More than any program writes; keeps the time for a damaged header small.
constexpr std::size_t kMostProperties = 1000;

class HeaderReader {
 public:
  HeaderReader(std::string_view contents, const std::string& file) : lines_(contents, file), file_(file) {}

  PlyHeader read() {
    if (lines_.line() != "ply") throw InputError({file_, 1, 0, ""}, "this is not a PLY file", "a first line 'ply'");
    bool has_form = false;
    while (true) {
      if (lines_.at_end()) lines_.fail("", "the header does not end", "a line 'end_header'");
      offset_ = lines_.position();
      line_ = lines_.line();
      const std::string_view word = next();
      if (word == "end_header") break;
      if (word == "format") {
        read_form();
        has_form = true;
      } else if (word == "element") {
        read_element();
      } else if (word == "property") {
        read_property();
      } else if (word == "comment") {
        read_comment();
      } else if (word != "obj_info" && !word.empty()) {
        lines_.fail("", fmt::format("'{}' in the header", shown_word(word)),
                    "format, element, property, comment or end_header");
      }
    }
    if (!has_form) lines_.fail("format", "missing in the header", "a line 'format binary_little_endian 1.0'");
    header_.data = lines_.position();
    return std::move(header_);
  }

 private:
  std::string_view next() {
    while (!line_.empty() && is_blank(line_.front())) line_.remove_prefix(1);
    std::size_t length = 0;
    while (length < line_.size() && !is_blank(line_[length])) ++length;
    const std::string_view word = line_.substr(0, length);
    line_.remove_prefix(length);
    return word;
  }

  void read_form() {
    const std::string_view form = next(), version = next();
    if (form == "ascii") {
      header_.form = PlyForm::ascii;
    } else if (form == "binary_little_endian") {
      header_.form = PlyForm::binary_little_endian;
    } else if (form == "binary_big_endian") {
      header_.form = PlyForm::binary_big_endian;
    } else {
      lines_.fail("format", fmt::format("'{}'", shown_word(form)), "ascii, binary_little_endian or binary_big_endian");
    }
    if (version != "1.0") lines_.fail("format", fmt::format("version '{}'", shown_word(version)), "1.0");
  }

  void read_element() {
    PlyElement element;
    element.offset = offset_;
    element.name = std::string(next());
    const std::string_view count = next();
    if (element.name.empty() || count.empty() || count.size() > 18 ||
        count.find_first_not_of("0123456789") != std::string_view::npos) {
      lines_.fail("element", fmt::format("'{}' is not a number of elements", shown_word(count)),
                  "a line 'element NAME NUMBER'");
    }
    for (const char digit : count) element.count = element.count * 10 + static_cast<std::uint64_t>(digit - '0');
    for (const PlyElement& other : header_.elements) {
      if (other.name == element.name)
        lines_.fail("element", fmt::format("'{}' is given twice", shown_word(element.name)), "");
    }
    header_.elements.push_back(std::move(element));
  }

  PlyType type(std::string_view word) {
    for (const auto& [name, type] : kTypes) {
      if (name == word) return type;
    }
    lines_.fail("property", fmt::format("'{}' is not a type", shown_word(word)),
                "char, uchar, short, ushort, int, uint, float or double");
  }

  void read_property() {
    if (header_.elements.empty()) lines_.fail("property", "stands before the first element", "");
    PlyProperty property;
    std::string_view word = next();
    if (word == "list") {
      property.count_type = type(next());
      if (!ply_type_is_integer(*property.count_type)) {
        lines_.fail("property", "the length of a list is not a whole number",
                    "a list with a length of type uchar or int");
      }
      word = next();
    }
    property.type = type(word);
    property.name = std::string(next());
    if (property.name.empty()) lines_.fail("property", "has no name", "");
    PlyElement& element = header_.elements.back();
    if (element.find(property.name) < element.properties.size()) {
      lines_.fail("property", fmt::format("'{}' is given twice", shown_word(property.name)), "");
    }
    if (++properties_ > kMostProperties) lines_.fail("property", "too many properties", "at most 1000");
    element.properties.push_back(std::move(property));
  }

  void read_comment() {
    // Other words behind it are somebody's remark.
    if (next() != "unit") return;
    if (const auto unit = file_length_named(next())) header_.unit = unit;
  }

  TextCursor lines_;
  const std::string& file_;
  PlyHeader header_;
  std::string_view line_;
  std::size_t offset_ = 0;
  std::size_t properties_ = 0;
};

}  // namespace

std::size_t PlyElement::find(std::string_view property) const {
  std::size_t i = 0;
  while (i < properties.size() && properties[i].name != property) ++i;
  return i;
}

std::size_t ply_type_size(PlyType type) {
  switch (type) {
    case PlyType::int8:
    case PlyType::uint8:
      return 1;
    case PlyType::int16:
    case PlyType::uint16:
      return 2;
    case PlyType::float64:
      return 8;
    case PlyType::int32:
    case PlyType::uint32:
    case PlyType::float32:
      break;
  }
  return 4;
}

bool ply_type_is_integer(PlyType type) { return type != PlyType::float32 && type != PlyType::float64; }

PlyHeader parse_ply_header(std::string_view contents, const std::string& file) {
  return HeaderReader(contents, file).read();
}

}  // namespace abbe
