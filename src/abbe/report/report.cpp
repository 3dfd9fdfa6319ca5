#include "abbe/report/report.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string_view>

#include "abbe/formats/text/not_finite.h"
#include "abbe/report/pages/page_template.h"

namespace abbe {
namespace {

constexpr std::string_view kPlace = "@@ABBE_DATA@@";

/// JSON has no NaN: the writer would turn it into null, and an absent number would look intended.
void require_finite(const nlohmann::json& value, const std::string& path) {
  if (value.is_number_float() && !std::isfinite(value.get<double>())) {
    throw NotFinite("report data: " + path);
  }
  if (value.is_object()) {
    for (const auto& item : value.items())
      require_finite(item.value(), path.empty() ? item.key() : path + "." + item.key());
  } else if (value.is_array()) {
    for (std::size_t i = 0; i < value.size(); ++i) require_finite(value[i], path + "[" + std::to_string(i) + "]");
  }
}

/// In a script element only "</script" and "<!--" are special; without "<" neither can occur. Both spellings are the
/// same JSON text.
void append_escaped(const std::string& json, std::string& page) {
  for (const char c : json) {
    if (c == '<') {
      page += "\\u003c";
    } else {
      page += c;
    }
  }
}

}  // namespace

std::string report_page(const nlohmann::json& data) {
  if (!data.is_object() || data.value("format", nlohmann::json()) != "abbe-report/1") {
    throw std::invalid_argument("report data: \"format\" must be \"abbe-report/1\"");
  }
  if (!data.contains("title") || !data["title"].is_string()) {
    throw std::invalid_argument("report data: \"title\" must be a text");
  }
  require_finite(data, "");
  std::string empty_page;
  for (const std::string_view piece : page_template()) empty_page += piece;
  const std::size_t at = empty_page.find(kPlace);
  if (at == std::string::npos) throw std::logic_error("report template without a place for the data");

  const std::string json = data.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  std::string page;
  page.reserve(empty_page.size() + json.size() + json.size() / 64);
  page.append(empty_page, 0, at);
  append_escaped(json, page);
  page.append(empty_page, at + kPlace.size());
  return page;
}

}  // namespace abbe
