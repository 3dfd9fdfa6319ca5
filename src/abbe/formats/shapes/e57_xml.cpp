#include "abbe/formats/shapes/e57_xml.h"

#include <expat.h>
#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <memory>

#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

constexpr char kBehindUri = '|';
constexpr std::string_view kE57Uri = "http://www.astm.org/COMMIT/E57/";
constexpr std::string_view kNormalsUri = "http://www.libe57.org/E57_NOR_surface_normals.txt";
// What one call of expat is given, and what no file comes near to.
constexpr std::size_t kXmlTogether = 1U << 20U;
constexpr std::size_t kDeepestElement = 100;

/// Without the URI where it is known; the year and version of that of E57 vary.
std::string plain_name(std::string_view name) {
  const std::size_t mark = name.find(kBehindUri);
  if (mark == std::string_view::npos) return std::string(name);
  const std::string_view uri = name.substr(0, mark), local = name.substr(mark + 1);
  if (uri.starts_with(kE57Uri)) return std::string(local);
  if (uri == kNormalsUri) return "nor:" + std::string(local);
  return std::string(name);
}

/// Builds the tree. Exceptions must not pass through expat, which is C: they are kept until it has returned.
class E57TreeBuilder {
 public:
  explicit E57TreeBuilder(XML_Parser parser) : parser_(parser) {
    XML_SetUserData(parser, this);
    XML_SetElementHandler(parser, begin, end);
    XML_SetCharacterDataHandler(parser, text);
    XML_SetStartDoctypeDeclHandler(parser, doctype);
  }

  std::exception_ptr exception;
  const char* refusal = nullptr;
  E57Element root;

 private:
  static E57TreeBuilder& of(void* user) { return *static_cast<E57TreeBuilder*>(user); }

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
    E57TreeBuilder& builder = of(user);
    builder.guarded([&] {
      if (builder.open_.size() == kDeepestElement) {
        builder.refusal = "elements within more than 100 others";
        return;
      }
      E57Element element;
      element.name = plain_name(name);
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
    E57TreeBuilder& builder = of(user);
    builder.guarded([&] { builder.open_.pop_back(); });
  }

  static void text(void* user, const char* letters, int count) {
    E57TreeBuilder& builder = of(user);
    builder.guarded([&] {
      if (!builder.open_.empty()) builder.open_.back()->text.append(letters, static_cast<std::size_t>(count));
    });
  }

  static void doctype(void* user, const char*, const char*, const char*, int) {
    E57TreeBuilder& builder = of(user);
    builder.guarded([&] { builder.refusal = "a DOCTYPE"; });
  }

  XML_Parser parser_;
  std::vector<E57Element*> open_;
};

}  // namespace

const E57Element* E57Element::child(std::string_view wanted) const {
  const auto found =
      std::find_if(children.begin(), children.end(), [&](const E57Element& one) { return one.name == wanted; });
  return found == children.end() ? nullptr : &*found;
}

const std::string* E57Element::attribute(std::string_view wanted) const {
  const auto found =
      std::find_if(attributes.begin(), attributes.end(), [&](const auto& one) { return one.first == wanted; });
  return found == attributes.end() ? nullptr : &found->second;
}

E57Element parse_e57_xml(std::string_view xml, const std::string& file) {
  // Some writers fill the section up with zeros.
  while (!xml.empty() && xml.back() == '\0') xml.remove_suffix(1);
  const std::unique_ptr<XML_ParserStruct, decltype(&XML_ParserFree)> parser(XML_ParserCreateNS(nullptr, kBehindUri),
                                                                            &XML_ParserFree);
  if (!parser) throw std::bad_alloc();
  E57TreeBuilder builder(parser.get());
  for (std::size_t at = 0;;) {
    const std::size_t part = std::min(kXmlTogether, xml.size() - at);
    const bool is_last = at + part == xml.size();
    const XML_Status status =
        XML_Parse(parser.get(), xml.data() + at, static_cast<int>(part), is_last ? XML_TRUE : XML_FALSE);
    if (builder.exception) std::rethrow_exception(builder.exception);
    if (status != XML_STATUS_OK || builder.refusal != nullptr) {
      throw InputError(
          {.file = file, .field = "XML section"},
          fmt::format("in its line {}, column {}: {}", XML_GetCurrentLineNumber(parser.get()),
                      XML_GetCurrentColumnNumber(parser.get()) + 1,
                      builder.refusal != nullptr ? builder.refusal : XML_ErrorString(XML_GetErrorCode(parser.get()))),
          "XML as ASTM E2807 describes it");
    }
    if (is_last) break;
    at += part;
  }
  return std::move(builder.root);
}

}  // namespace abbe
