#include "abbe/formats/text/xml_tree.h"

#include <expat.h>

#include <algorithm>
#include <exception>
#include <memory>
#include <new>

namespace abbe {
namespace {

// What one call of expat is given, and what no file comes near to.
constexpr std::size_t kXmlTogether = 1U << 20U;
constexpr std::size_t kDeepestElement = 100;

/// Builds the tree. Exceptions must not pass through expat, which is C: they are kept until it has returned.
class XmlTreeBuilder {
 public:
  XmlTreeBuilder(XML_Parser parser, std::string (*plain_name)(std::string_view))
      : parser_(parser), plain_name_(plain_name) {
    XML_SetUserData(parser, this);
    XML_SetElementHandler(parser, begin, end);
    XML_SetCharacterDataHandler(parser, text);
    XML_SetStartDoctypeDeclHandler(parser, doctype);
  }

  /// Why expat does not accept the document, in words.
  std::string problem(bool is_last) const {
    if (refusal != nullptr) return refusal;
    const XML_Error error = XML_GetErrorCode(parser_);
    const bool is_unfinished = error == XML_ERROR_NO_ELEMENTS || error == XML_ERROR_UNCLOSED_TOKEN ||
                               error == XML_ERROR_UNCLOSED_CDATA_SECTION || error == XML_ERROR_PARTIAL_CHAR;
    if (is_last && is_unfinished && !open_.empty()) {
      return "the document ends within " + open_.back()->name + ", so it is incomplete";
    }
    return XML_ErrorString(error);
  }

  std::exception_ptr exception;
  const char* refusal = nullptr;
  XmlElement root;

 private:
  static XmlTreeBuilder& of(void* user) { return *static_cast<XmlTreeBuilder*>(user); }

  template <typename Action>
  void guarded(const Action& action) noexcept {
    if (exception || refusal != nullptr) return;
    try {
      action();
    } catch (...) {
      exception = std::current_exception();
    }
    if (exception || refusal != nullptr) XML_StopParser(parser_, XML_FALSE);
  }

  static void begin(void* user, const char* name, const char** attributes) {
    XmlTreeBuilder& builder = of(user);
    builder.guarded([&] {
      if (builder.open_.size() == kDeepestElement) {
        builder.refusal = "elements within more than 100 others";
        return;
      }
      XmlElement element;
      element.name = builder.plain_name_(name);
      element.line = XML_GetCurrentLineNumber(builder.parser_);
      for (; *attributes != nullptr; attributes += 2) element.attributes.emplace_back(attributes[0], attributes[1]);
      if (builder.open_.empty()) {
        builder.root = std::move(element);
        builder.open_.push_back(&builder.root);
      } else {
        // Only the children of the innermost element are added to, so that no place in open_ moves.
        builder.open_.push_back(&builder.open_.back()->children.emplace_back(std::move(element)));
      }
    });
  }

  static void end(void* user, const char*) {
    XmlTreeBuilder& builder = of(user);
    builder.guarded([&] { builder.open_.pop_back(); });
  }

  static void text(void* user, const char* letters, int count) {
    XmlTreeBuilder& builder = of(user);
    builder.guarded([&] {
      if (!builder.open_.empty()) builder.open_.back()->text.append(letters, static_cast<std::size_t>(count));
    });
  }

  static void doctype(void* user, const char*, const char*, const char*, int) {
    XmlTreeBuilder& builder = of(user);
    builder.guarded([&] { builder.refusal = "a DOCTYPE"; });
  }

  XML_Parser parser_;
  std::string (*plain_name_)(std::string_view);
  std::vector<XmlElement*> open_;
};

}  // namespace

const XmlElement* XmlElement::child(std::string_view wanted) const {
  const auto found =
      std::find_if(children.begin(), children.end(), [&](const XmlElement& one) { return one.name == wanted; });
  return found == children.end() ? nullptr : &*found;
}

const std::string* XmlElement::attribute(std::string_view wanted) const {
  const auto found =
      std::find_if(attributes.begin(), attributes.end(), [&](const auto& one) { return one.first == wanted; });
  return found == attributes.end() ? nullptr : &found->second;
}

XmlTree parse_xml(std::string_view xml, std::string (*plain_name)(std::string_view), const char* encoding) {
  const std::unique_ptr<XML_ParserStruct, decltype(&XML_ParserFree)> parser(XML_ParserCreateNS(encoding, kBehindXmlUri),
                                                                            &XML_ParserFree);
  if (!parser) throw std::bad_alloc();
  XmlTree result;
  XmlTreeBuilder builder(parser.get(), plain_name);
  for (std::size_t at = 0;;) {
    const std::size_t part = std::min(kXmlTogether, xml.size() - at);
    const bool is_last = at + part == xml.size();
    const XML_Status status =
        XML_Parse(parser.get(), xml.data() + at, static_cast<int>(part), is_last ? XML_TRUE : XML_FALSE);
    if (builder.exception) std::rethrow_exception(builder.exception);
    if (status != XML_STATUS_OK || builder.refusal != nullptr) {
      result.problem = {XML_GetCurrentLineNumber(parser.get()), XML_GetCurrentColumnNumber(parser.get()) + 1,
                        builder.problem(is_last)};
      return result;
    }
    if (is_last) break;
    at += part;
  }
  result.root = std::move(builder.root);
  return result;
}

std::string_view xml_trimmed(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r\n";
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

std::string local_xml_name(std::string_view name) {
  const std::size_t mark = name.rfind(kBehindXmlUri);
  return std::string(mark == std::string_view::npos ? name : name.substr(mark + 1));
}

}  // namespace abbe
