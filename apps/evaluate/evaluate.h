#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "abbe/study/evaluations/evaluation.h"
#include "column_options.h"

namespace abbe {

class ResultsFolder;
class Subcommand;
struct CommandLine;

/// What every kind of evaluation is asked.
struct EvaluationOptions {
  std::string file;                     ///< readings
  std::string output;                   ///< results folder; empty: print only
  ColumnOptions columns;                ///< of the file
  std::vector<std::string> tolerances;  ///< "A_um=10"
  bool json = false;
  std::string customer_report;  ///< file to write; empty: none
  std::string qif;              ///< the same as results in QIF: file to write; empty: none
  std::string facts;            ///< of both; empty: none are stated
  std::string before;           ///< readings before a correction; empty: none
};

/// `abbe evaluate KIND`: adds the subcommand with the options of every kind; its own options come behind it.
/// @param evaluate  the command `evaluate`
/// @param columns   of the file, shown by --help; empty: the file is a study
/// @param renamed   example of a column with another name: "deviation_um=error"
Subcommand* add_evaluation(Subcommand& evaluate, const std::string& kind, const std::string& description,
                           const std::string& columns, const std::string& renamed, const std::string& example,
                           EvaluationOptions& options);

/// Options of a customer report.
void add_customer_report_options(Subcommand& command, EvaluationOptions& options);

/// Options of a correction to 20 degC.
void add_expansion(Subcommand& command, std::span<const TestNumber<ExpansionNumbers>> list, ExpansionNumbers& numbers);

/// Prints the report for people or programs and writes the results folder: evaluation.json, one SVG file per plot,
/// report.html. @returns kNegative if a tolerance is exceeded or a figure with one could not be evaluated, else kDone
/// @param files  more for the results folder: name, contents; `write_more` writes what else belongs there
int finish_evaluation(const EvaluationReport& report, const EvaluationOptions& options,
                      const std::vector<std::pair<std::string, std::string>>& files = {},
                      const std::function<void(ResultsFolder&)>& write_more = {});

/// Evaluates the readings of the file and finishes with them; writes the customer report, which also shows the same
/// test with the readings before a correction. @returns kNegative also if the evaluation is refused
/// @param test_of  the test with the readings of a file
int run_evaluation(const EvaluationOptions& options,
                   const std::function<TestToEvaluate(const std::string& file)>& test_of);

// One per kind, or for all of a kind; each leaves its work in line.run.
void add_evaluate_positioning(Subcommand& evaluate, CommandLine& line);
void add_evaluate_diagonals(Subcommand& evaluate, CommandLine& line);
void add_evaluate_circular(Subcommand& evaluate, CommandLine& line);
void add_evaluate_rotation(Subcommand& evaluate, CommandLine& line);
void add_evaluate_straightness(Subcommand& evaluate, CommandLine& line);
void add_evaluate_squareness(Subcommand& evaluate, CommandLine& line);
void add_evaluate_contour(Subcommand& evaluate, CommandLine& line);
void add_evaluate_linkage(Subcommand& evaluate, CommandLine& line);
void add_evaluate_thermal(Subcommand& evaluate, CommandLine& line);

}  // namespace abbe
