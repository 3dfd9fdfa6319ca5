#include "abbe/report/pages/measuring_sheet.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>

#include "abbe/report/customer/customer_style.h"
#include "abbe/report/drawings/svg_drawing.h"
#include "abbe/report/version.h"

namespace abbe {
namespace {

constexpr const char* kSheetStyle = R"css(
dd.blank{border-bottom:.4pt solid var(--ink);min-height:1.2em}
section.warning p{font-weight:normal}
table.readings{margin-top:5mm}
table.readings td{padding-top:1mm;padding-bottom:1mm;white-space:nowrap}
table.readings .words{white-space:normal;text-align:left}
table.readings th.blank,table.readings td.blank{border-left:.4pt solid var(--line);text-align:left;width:26mm}
)css";

/// Whether a column has numbers, to be set to the right and on one line; words may be long.
bool has_numbers(const MeasuringSheetTable& table, std::size_t column) {
  return std::all_of(table.rows.begin(), table.rows.end(), [column](const std::vector<std::string>& row) {
    return row[column].find_first_not_of("0123456789.-+:") == std::string::npos;
  });
}

std::string sheet_table(const MeasuringSheetTable& table) {
  std::string html = fmt::format("<table class=\"readings{}\">\n<caption>{}</caption>\n<thead><tr>",
                                 table.rows.size() <= 12 ? " short" : "", xml_text(table.caption));
  std::vector<const char*> kinds;
  for (std::size_t k = 0; k < table.headers.size(); ++k) {
    kinds.push_back(has_numbers(table, k) ? "" : " class=\"words\"");
    html += fmt::format("<th{}>{}</th>", kinds.back(), xml_text(table.headers[k]));
  }
  for (const std::string& header : table.blank) html += "<th class=\"blank\">" + xml_text(header) + "</th>";
  html += "</tr></thead>\n<tbody>\n";
  for (const std::vector<std::string>& row : table.rows) {
    html += "<tr>";
    for (std::size_t k = 0; k < row.size(); ++k) html += fmt::format("<td{}>{}</td>", kinds[k], xml_text(row[k]));
    for (std::size_t k = 0; k < table.blank.size(); ++k) html += "<td class=\"blank\"></td>";
    html += "</tr>\n";
  }
  return html + "</tbody>\n</table>\n";
}

}  // namespace

std::string measuring_sheet_page(const MeasuringSheet& sheet) {
  const std::string producer = std::string("abbe ") + version_text();
  std::string page = fmt::format(
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta name=\"generator\" content=\"{}\">\n<title>{}</title>\n<style>\n{}{}</style>\n</head>\n<body>\n"
      "<header><h1>{}</h1><p>{}</p></header>\n<dl>\n",
      producer, xml_text(sheet.title), customer_style(sheet.title), kSheetStyle, xml_text(sheet.title),
      xml_text(sheet.subtitle));
  for (const auto& [name, text] : sheet.facts) {
    page += fmt::format("<div><dt>{}</dt><dd{}>{}</dd></div>\n", xml_text(name), text.empty() ? " class=\"blank\"" : "",
                        xml_text(text));
  }
  page += "</dl>\n";
  if (!sheet.notes.empty()) {
    page += "<section class=\"warning\">\n";
    for (const std::string& note : sheet.notes) page += "<p>" + xml_text(note) + "</p>\n";
    page += "</section>\n";
  }
  for (const MeasuringSheetTable& table : sheet.tables) page += sheet_table(table);
  return page + fmt::format("<p class=\"small\">{}</p>\n</body>\n</html>\n", producer);
}

}  // namespace abbe
