#include "abbe/formats/shapes/e57_xml.h"

#include <fmt/format.h>

#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

constexpr std::string_view kE57Uri = "http://www.astm.org/COMMIT/E57/";
constexpr std::string_view kNormalsUri = "http://www.libe57.org/E57_NOR_surface_normals.txt";

/// Without the URI where it is known; the year and version of that of E57 vary.
std::string plain_e57_name(std::string_view name) {
  const std::size_t mark = name.find(kBehindXmlUri);
  if (mark == std::string_view::npos) return std::string(name);
  const std::string_view uri = name.substr(0, mark), local = name.substr(mark + 1);
  if (uri.starts_with(kE57Uri)) return std::string(local);
  if (uri == kNormalsUri) return "nor:" + std::string(local);
  return std::string(name);
}

}  // namespace

E57Element parse_e57_xml(std::string_view xml, const std::string& file) {
  // Some writers fill the section up with zeros.
  while (!xml.empty() && xml.back() == '\0') xml.remove_suffix(1);
  XmlTree tree = parse_xml(xml, plain_e57_name);
  if (tree.problem) {
    throw InputError(
        {.file = file, .field = "XML section"},
        fmt::format("in its line {}, column {}: {}", tree.problem->line, tree.problem->column, tree.problem->words),
        "XML as ASTM E2807 describes it");
  }
  return std::move(tree.root);
}

}  // namespace abbe
