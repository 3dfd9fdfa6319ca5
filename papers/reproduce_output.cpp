#include "reproduce_output.h"

#include <fmt/format.h>

#include <cassert>
#include <cctype>
#include <cmath>

#include "abbe/formats/text/json_text.h"
#include "abbe/formats/text/number_text.h"
#include "abbe/report/pages/evaluation_data.h"
#include "abbe/report/report.h"
#include "exit_code.h"
#include "reproduce_text.h"

namespace abbe {
namespace {

/// A unit as the end of a key.
std::string unit_key(const std::string& unit) {
  if (unit == "%") return "percent";
  std::string key;
  for (const char c : unit) key += c == '/' ? std::string("_per_") : std::string(1, c);
  return key;
}

std::string csv_text(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

nlohmann::ordered_json cell_json(const ReproducedCell& cell) {
  if (!cell.has_value()) return nullptr;
  if (const std::string* text = cell.text()) return *text;
  const double* number = cell.number();
  if (cell.decimals == 0 && *number == std::rint(*number)) return static_cast<std::int64_t>(*number);
  return *number;
}

nlohmann::ordered_json table_json(const ReproducedTable& table) {
  nlohmann::ordered_json json = {{"title", table.title}, {"rows", nlohmann::ordered_json::array()}};
  for (const std::vector<ReproducedCell>& row : table.rows) {
    nlohmann::ordered_json entry;
    for (std::size_t i = 0; i < row.size(); ++i) entry[column_key(table.columns[i])] = cell_json(row[i]);
    json["rows"].push_back(std::move(entry));
  }
  return json;
}

constexpr std::size_t kLongestOnPage = 200;  // rows

nlohmann::json page_table(const ReproducedTable& table) {
  nlohmann::json columns = nlohmann::json::array(), rows = nlohmann::json::array();
  if (table.rows.size() > kLongestOnPage) {
    columns = {"rows", "file"};
    rows.push_back(nlohmann::json::array({fmt::format("{}", table.rows.size()), "tables/" + table.name + ".csv"}));
    return {{"title", table.title}, {"columns", std::move(columns)}, {"rows", std::move(rows)}};
  }
  for (const ReproducedColumn& column : table.columns) {
    columns.push_back(column.unit.empty() ? column.name : column.name + " / " + unit_symbol(column.unit));
  }
  for (const std::vector<ReproducedCell>& row : table.rows) {
    nlohmann::json cells = nlohmann::json::array();
    for (std::size_t i = 0; i < row.size(); ++i) {
      std::string text = cell_text(row[i], table.columns[i]);
      if (table.columns[i].name == "unit") text = unit_symbol(text);
      cells.push_back(row[i].has_value() ? nlohmann::json(text) : nlohmann::json());
    }
    rows.push_back(std::move(cells));
  }
  nlohmann::json json = {{"title", table.title}, {"columns", std::move(columns)}, {"rows", std::move(rows)}};
  std::string note;
  for (const std::string& paragraph : table.notes) note += (note.empty() ? "" : " ") + paragraph;
  if (!note.empty()) json["note"] = note;
  return json;
}

std::vector<const ReproducedTable*> with_published(const Reproduction& made, const ReproducedTable& published) {
  std::vector<const ReproducedTable*> tables;
  if (!published.rows.empty()) tables.push_back(&published);
  for (const ReproducedTable& table : made.tables) tables.push_back(&table);
  return tables;
}

}  // namespace

const double* ReproducedCell::number() const {
  const double* number = std::get_if<double>(&value);
  return number != nullptr && std::isfinite(*number) ? number : nullptr;
}

void add_columns(ReproducedTable& table, const std::vector<std::string>& names, const std::string& unit, int decimals) {
  for (const std::string& name : names) table.columns.push_back({name, unit, decimals});
}

std::string column_key(const ReproducedColumn& column) {
  std::string key;
  for (const char c : column.name) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) {
      key += c;
    } else if (c == '%') {
      key += "percent";
    } else if (!key.empty() && key.back() != '_') {
      key += '_';
    }
  }
  while (!key.empty() && key.back() == '_') key.pop_back();
  return column.unit.empty() ? key : key + "_" + unit_key(column.unit);
}

ReproducedTable published_table(const Reproduction& made) {
  ReproducedTable table{"published",
                        "What the paper states, and what is found here",
                        {{"where", ""}, {"unit", ""}, {"paper", ""}, {"here", ""}, {"difference", ""}, {"note", ""}},
                        {},
                        {}};
  for (const PublishedNumber& number : made.published) {
    const auto cell = [&](const std::optional<double>& value) {
      return value ? ReproducedCell(*value, number.decimals) : ReproducedCell();
    };
    std::optional<double> difference;
    if (number.paper && number.here) {
      // What only the rounding of the sums leaves is no difference.
      constexpr double kRounding = 1e-12;
      const double off = *number.here - *number.paper;
      difference = std::abs(off) <= kRounding * (1 + std::abs(*number.paper)) ? 0 : off;
    }
    table.rows.push_back(
        {number.where, number.unit, cell(number.paper), cell(number.here), cell(difference), number.note});
  }
  return table;
}

nlohmann::ordered_json reproduction_json(const Reproduction& made) {
  nlohmann::ordered_json json = {
      {"format", "abbe-reproduction/1"}, {"paper", made.paper}, {"citation", made.citation}, {"title", made.title}};
  // The same keys for every paper: what it does not have is null or empty.
  json["agrees_with_reference"] = made.agrees ? nlohmann::ordered_json(*made.agrees) : nullptr;
  json["failures"] = made.failures;
  json["facts"] = json["tables"] = nlohmann::ordered_json::object();
  for (const auto& [name, text] : made.facts) json["facts"][name] = text;
  json["published"] = table_json(published_table(made))["rows"];
  for (const ReproducedTable& table : made.tables) json["tables"][table.name] = table_json(table);
  json["conclusions"] = made.conclusions;
  json["wrong_in_print"] = made.corrections;
  json["details"] = made.details;
  return json;
}

std::string reproduction_csv(const ReproducedTable& table) {
  std::string text;
  for (std::size_t i = 0; i < table.columns.size(); ++i) text += (i == 0 ? "" : ",") + column_key(table.columns[i]);
  text += '\n';
  for (const std::vector<ReproducedCell>& row : table.rows) {
    assert(row.size() == table.columns.size());
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (i != 0) text += ',';
      if (const std::string* words = row[i].text()) text += csv_text(*words);
      if (const double* number = row[i].number()) text += shortest_text(*number);
    }
    text += '\n';
  }
  return text;
}

std::string reproduction_page(const Reproduction& made) {
  EvaluationReport report;
  report.kind = "reproduce " + made.paper;
  report.title = made.title;
  report.standard = made.citation + ", recomputed";
  report.facts = made.facts;
  if (made.agrees) report.facts.emplace_back("reference numbers", *made.agrees ? "met" : "NOT met");
  report.figures = made.headline;
  report.plots = made.figures;
  for (const std::string& failure : made.failures) report.notes.push_back("Not found: " + failure + ".");
  for (const std::string& words : made.conclusions) report.notes.push_back(words);
  for (const std::string& words : made.corrections) report.notes.push_back("Wrong in print: " + words);
  report.page = made.page;
  nlohmann::json data = evaluation_data(report);
  // Figures of a paper are shown whatever else the page draws.
  data["evaluation"]["drawings"] = nlohmann::json::array();
  for (const EvaluationPlot& plot : made.figures) {
    if (!plot.in_page) data["evaluation"]["drawings"].push_back(drawing_data(plot));
  }
  const ReproducedTable published = published_table(made);
  for (const ReproducedTable* table : with_published(made, published)) data["tables"].push_back(page_table(*table));
  return report_page(data);
}

void write_reproduction(const Reproduction& made, const std::filesystem::path& folder) {
  ResultsFolder out(folder);
  const std::filesystem::path tables = "tables", figures = "figures";
  out.write("summary.json", json_text(reproduction_json(made)));
  out.write("report.html", reproduction_page(made));
  const ReproducedTable published = published_table(made);
  for (const ReproducedTable* table : with_published(made, published)) {
    out.write(tables / (table->name + ".csv"), reproduction_csv(*table));
  }
  for (const EvaluationPlot& plot : made.figures) out.write(figures / (plot.name + ".svg"), plot.picture.wide);
  if (made.write_study) made.write_study(out);
  out.commit();
}

int run_reproduction(const ReproduceOptions& options, const std::function<Reproduction()>& compute) {
  // A folder that cannot be written is refused before minutes of work, not after.
  if (!options.output.empty()) check_results_folder(options.output);
  const Reproduction made = compute();
  if (!options.output.empty()) write_reproduction(made, options.output);
  if (options.json) {
    fmt::print("{}", json_text(reproduction_json(made)));
  } else {
    fmt::print("{}", reproduction_text(made));
    if (!options.output.empty()) {
      fmt::print("\nresults in {}\nreport:    {}\n", options.output,
                 (std::filesystem::path(options.output) / "report.html").string());
    }
  }
  return made.successful() ? kDone : kNegative;
}

}  // namespace abbe
