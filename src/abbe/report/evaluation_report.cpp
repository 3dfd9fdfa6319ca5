#include "abbe/report/evaluation_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "abbe/report/svg_drawing.h"

namespace abbe {
namespace {

constexpr const char* kStyle =
    ":root{--paper:#fff;--raised:#f6f7f8;--line:#dfe3e7;--ink:#1a2127;--soft:#56616b;--bad:#b3261e;--good:#0b6e75;"
    "--warn:#7a4b00;color-scheme:light dark;"
    "font-family:Inter,'Segoe UI',system-ui,-apple-system,'Helvetica Neue','Liberation Sans',Arial,sans-serif}"
    "@media screen and (prefers-color-scheme:dark){:root{--paper:#12171b;--raised:#1a2126;--line:#2b343b;--ink:#e6eaed;"
    "--soft:#a3adb6;--bad:#ff8a80;--good:#5cc3c9;--warn:#f0c674}}"
    "body{margin:0 auto;max-width:62rem;padding:2rem 1.25rem 4rem;background:var(--paper);color:var(--ink);"
    "line-height:1.5;font-variant-numeric:tabular-nums}"
    "h1{font-size:1.6rem;line-height:1.2;margin:0}h2{font-size:1.1rem;margin:2.2rem 0 .6rem}"
    "h1,p,li,dd,td{overflow-wrap:anywhere}.standard{color:var(--soft);margin:.3rem 0 1.2rem}"
    "dl{display:flex;flex-wrap:wrap;gap:.6rem 2rem;margin:0}dt{font-size:.75rem;color:var(--soft)}dd{margin:0}"
    ".wide{overflow-x:auto;margin-bottom:1.6rem}table{border-collapse:collapse;font-size:.9rem}"
    "caption{text-align:left;white-space:nowrap;color:var(--soft);padding-bottom:.4rem}"
    "th,td{padding:.28rem .8rem;border-bottom:1px solid var(--line);text-align:right}"
    "th{color:var(--soft);font-weight:500}th.text,td.text{text-align:left}td.symbol{text-align:left;font-weight:600}"
    ".exceeded{color:var(--bad);font-weight:600}.within{color:var(--good)}.undecided{color:var(--warn)}"
    "figure{margin:1rem 0}figcaption{color:var(--soft);font-size:.9rem}svg{max-width:100%;height:auto}"
    "ul{padding-left:1.2rem}@media print{body{max-width:none}figure{break-inside:avoid}}";

/// In the unit shown, without the last digits that the conversion of the unit makes up.
double in_unit(const EvaluationFigure& figure, double value) {
  const Unit& unit = unit_named(figure.quantity, figure.unit);
  const double shown = value / unit.factor * std::pow(10, -unit.decimal_shift);
  return std::round(shown * 1e9) / 1e9;
}

const char* verdict(const EvaluationFigure& figure) {
  if (!figure.tolerance) return "";
  if (!figure.value) return "cannot be judged";
  if (figure.exceeds_tolerance()) return figure.is_undecided() ? "exceeded, not proven" : "exceeded";
  return figure.is_undecided() ? "within, not proven" : "within";
}

const char* verdict_class(const EvaluationFigure& figure) {
  if (figure.exceeds_tolerance()) return "exceeded";
  return figure.is_undecided() ? "undecided" : "within";
}

std::string figures_table(const std::vector<EvaluationFigure>& figures) {
  const auto any = [&](auto test) { return std::any_of(figures.begin(), figures.end(), test); };
  const bool uncertainty = any([](const EvaluationFigure& figure) { return figure.uncertainty.has_value(); });
  const bool tolerance = any([](const EvaluationFigure& figure) { return figure.tolerance.has_value(); });
  std::string text =
      "<div class=\"wide\"><table><tr><th class=\"text\"></th><th class=\"text\">figure</th><th>value</th>";
  if (uncertainty) text += "<th>U (k = 2)</th>";
  text += "<th class=\"text\">unit</th>";
  if (tolerance) text += "<th>tolerance</th><th class=\"text\"></th>";
  text += "</tr>\n";
  for (const EvaluationFigure& figure : figures) {
    text += fmt::format("<tr><td class=\"symbol\">{}</td><td class=\"text\">{}</td>", xml_text(figure.symbol),
                        xml_text(figure.name));
    const std::size_t columns = uncertainty ? 3 : 2;
    if (figure.value) {
      text += fmt::format("<td>{}</td>", figure_text(figure, *figure.value));
      if (uncertainty) {
        text += fmt::format("<td>{}</td>", figure.uncertainty ? figure_text(figure, *figure.uncertainty) : "");
      }
      text += fmt::format("<td class=\"text\">{}</td>", unit_symbol(figure.unit));
    } else {
      text +=
          fmt::format("<td class=\"text\" colspan=\"{}\">not evaluated: {}</td>", columns, xml_text(figure.missing));
    }
    if (tolerance) {
      text += fmt::format("<td>{}</td><td class=\"text {}\">{}</td>",
                          figure.tolerance ? figure_text(figure, *figure.tolerance) : "", verdict_class(figure),
                          verdict(figure));
    }
    text += "</tr>\n";
  }
  return text + "</table></div>\n";
}

std::string table_text(const EvaluationTable& table) {
  std::string text = "<div class=\"wide\"><table>";
  if (!table.caption.empty()) text += fmt::format("<caption>{}</caption>", xml_text(table.caption));
  text += "<tr>";
  for (const std::string& header : table.headers) text += fmt::format("<th>{}</th>", xml_text(header));
  text += "</tr>\n";
  for (const std::vector<std::string>& row : table.rows) {
    text += "<tr>";
    for (const std::string& cell : row) text += fmt::format("<td>{}</td>", xml_text(cell));
    text += "</tr>\n";
  }
  return text + "</table></div>\n";
}

}  // namespace

bool EvaluationFigure::is_undecided() const {
  return tolerance && value && uncertainty && std::abs(std::abs(*value) - *tolerance) < *uncertainty;
}

bool EvaluationReport::exceeds_tolerance() const {
  return std::any_of(figures.begin(), figures.end(),
                     [](const EvaluationFigure& figure) { return figure.exceeds_tolerance(); });
}

std::string figure_text(const EvaluationFigure& figure, double value) {
  std::string text = fmt::format("{:.{}f}", in_unit(figure, value), figure.decimals);
  const bool is_zero = text.find_first_of("123456789") == std::string::npos;
  return is_zero && text.starts_with('-') ? text.substr(1) : text;
}

std::string unit_symbol(const std::string& unit) {
  if (unit == "um") return "\xC2\xB5m";
  if (unit == "um_per_m") return "\xC2\xB5m/m";
  if (unit == "urad") return "\xC2\xB5rad";
  if (unit == "deg") return "\xC2\xB0";
  return unit;
}

nlohmann::ordered_json evaluation_json(const EvaluationReport& report) {
  nlohmann::ordered_json json;
  json["format"] = "abbe-evaluation/1";
  json["kind"] = report.kind;
  json["title"] = report.title;
  json["standard"] = report.standard;
  for (const auto& [name, text] : report.facts) json["facts"][name] = text;
  bool tolerances = false;
  for (const EvaluationFigure& figure : report.figures) {
    nlohmann::ordered_json entry;
    entry["name"] = figure.name;
    const auto add = [&](const std::string& key, const std::optional<double>& value) {
      if (!value) return;
      entry[figure.unit.empty() ? key : key + "_" + figure.unit] = in_unit(figure, *value);
    };
    add("value", figure.value);
    if (!figure.value) entry["not_evaluated"] = figure.missing;
    add("expanded_uncertainty", figure.uncertainty);
    add("tolerance", figure.tolerance);
    if (figure.tolerance) entry["verdict"] = verdict(figure);
    tolerances = tolerances || figure.tolerance;
    json["figures"][figure.symbol] = std::move(entry);
  }
  if (tolerances) json["within_tolerance"] = !report.exceeds_tolerance();
  json["notes"] = report.notes;
  if (report.details.is_object()) json.update(report.details);
  return json;
}

std::string evaluation_page(const EvaluationReport& report) {
  std::string page = fmt::format(
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{0}</title>\n"
      "<style>{1}</style>\n</head>\n<body>\n<h1>{0}</h1>\n<p class=\"standard\">{2}</p>\n",
      xml_text(report.title), kStyle, xml_text(report.standard));
  if (!report.facts.empty()) page += "<dl>\n";
  for (const auto& [name, text] : report.facts) {
    page += fmt::format("<div><dt>{}</dt><dd>{}</dd></div>\n", xml_text(name), xml_text(text));
  }
  if (!report.facts.empty()) page += "</dl>\n";
  page += "<h2>Figures</h2>\n" + figures_table(report.figures);
  for (const EvaluationPlot& plot : report.plots) {
    page += fmt::format("<figure>{}", plot.svg);
    if (!plot.caption.empty()) page += fmt::format("<figcaption>{}</figcaption>", xml_text(plot.caption));
    page += "</figure>\n";
  }
  if (!report.notes.empty()) {
    page += "<h2>Notes</h2>\n<ul>\n";
    for (const std::string& note : report.notes) page += fmt::format("<li>{}</li>\n", xml_text(note));
    page += "</ul>\n";
  }
  if (!report.tables.empty()) page += "<h2>Details</h2>\n";
  for (const EvaluationTable& table : report.tables) page += table_text(table);
  return page + "</body>\n</html>\n";
}

}  // namespace abbe
