#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "abbe/formats/files/results_folder.h"
#include "abbe/report/evaluations/evaluation_report.h"
#include "papers.h"

// What `abbe reproduce` says of a paper, the same for all papers: a study fills one Reproduction, and
// run_reproduction() prints it, writes it as JSON and as a folder. Nothing here computes.
//
//   Reproduction made;
//   made.paper = "ma";
//   made.published.push_back({"Table 3, eps_x before", "arcsec", 26.15, 25.9});
//   made.tables.push_back({"rank", "What the readings can see", {{"mounts"}, {"rank", "", 0}}, {{"one", 72}}});

namespace abbe {

/// A column of a table.
struct ReproducedColumn {
  std::string name;    ///< "largest deviation"
  std::string unit{};  ///< of its numbers, such as "um"; empty: texts, counts, ratios, or named by another column
  int decimals = 2;    ///< of its numbers in text; files have all digits
};

/// A text, a number in the unit of its column, or nothing. A number that is not finite is nothing too.
struct ReproducedCell {
  std::variant<std::monostate, std::string, double> value;
  std::optional<int> decimals;  ///< other than those of the column

  ReproducedCell() = default;
  // NOLINTBEGIN(google-explicit-constructor): rows are written as lists of texts and numbers
  ReproducedCell(const char* text) : value(std::string(text)) {}
  ReproducedCell(std::string text) : value(std::move(text)) {}
  ReproducedCell(double number) : value(number) {}
  ReproducedCell(double number, int shown_decimals) : value(number), decimals(shown_decimals) {}
  ReproducedCell(std::size_t count) : value(static_cast<double>(count)), decimals(0) {}
  ReproducedCell(int count) : value(static_cast<double>(count)), decimals(0) {}
  ReproducedCell(std::optional<double> number) {
    if (number) value = *number;
  }
  // NOLINTEND(google-explicit-constructor)

  /// Null if this is not a text.
  const std::string* text() const { return std::get_if<std::string>(&value); }
  /// Null if this is not a finite number.
  const double* number() const;
  /// Whether there is a text or a finite number. If not: null in JSON and on the page, empty in CSV; in text "-" in a
  /// column of numbers, else blank.
  bool has_value() const { return text() != nullptr || number() != nullptr; }
};

struct ReproducedTable {
  std::string name;   ///< of its file, without ".csv": "table-3"
  std::string title;  ///< one line
  std::vector<ReproducedColumn> columns;
  std::vector<std::vector<ReproducedCell>> rows = {};
  std::vector<std::string> notes = {};  ///< paragraphs below it
  bool in_text = true;  ///< false: a long one, for files and the page, which names the file beyond 200 rows
};

/// Appends columns with one unit and the same number of decimals.
void add_columns(ReproducedTable& table, const std::vector<std::string>& names, const std::string& unit,
                 int decimals = 2);

/// A number that the paper states, beside ours. Without ours the note says what is missing to compute it.
struct PublishedNumber {
  std::string where;  ///< "Table 2, average final error"
  std::string unit;
  std::optional<double> paper = {}, here = {};
  std::string note = {};
  int decimals = 2;
};

/// A study as it is shown and written.
struct Reproduction {
  std::string paper;     ///< as in the command: "aguado"
  std::string citation;  ///< authors, journal, year
  std::string title;     ///< what was studied on which machine
  std::vector<std::pair<std::string, std::string>> facts;
  std::vector<ReproducedTable> tables;
  std::vector<PublishedNumber> published;
  std::vector<EvaluationPlot> figures;     ///< names are those of the files: "figure-6"
  std::vector<std::string> conclusions;    ///< what the rows above show
  std::vector<std::string> corrections;    ///< what is wrong in print
  std::vector<std::string> failures;       ///< what was to be found and is not
  std::optional<bool> agrees;              ///< with the reference numbers; empty: there are none
  nlohmann::ordered_json details;          ///< more for programs, with keys of its own; an object or null
  std::vector<EvaluationFigure> headline;  ///< of the page, above everything
  nlohmann::json page;                     ///< more sections of the page (docs/report-data.md), or null
  /// Machine, errors, readings, paths of the study; null: none.
  std::function<void(ResultsFolder& folder)> write_study;

  bool successful() const { return agrees.value_or(true) && failures.empty(); }
};

/// Header of a column in a CSV file, and its key in JSON: "largest_deviation_um".
std::string column_key(const ReproducedColumn& column);

/// The published numbers as a table with their difference.
ReproducedTable published_table(const Reproduction& made);

/// Summary for programs: summary.json, and what --json prints.
nlohmann::ordered_json reproduction_json(const Reproduction& made);
/// For people: at most 118 columns wide where words can be wrapped.
std::string reproduction_text(const Reproduction& made);
/// One table as CSV, with units in the header.
std::string reproduction_csv(const ReproducedTable& table);
/// report.html
std::string reproduction_page(const Reproduction& made);

/// Writes summary.json, report.html, tables/NAME.csv, figures/NAME.svg and the files of the study.
/// @throws InputError if the folder cannot be written
void write_reproduction(const Reproduction& made, const std::filesystem::path& folder);

/// Checks the folder, computes, writes, prints. @returns an ExitCode: kNegative if it does not agree or something
/// failed
int run_reproduction(const ReproduceOptions& options, const std::function<Reproduction()>& compute);

}  // namespace abbe
