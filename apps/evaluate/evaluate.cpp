#include "evaluate/evaluate.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>

#include "abbe/formats/files/file_name.h"
#include "abbe/formats/files/results_folder.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/json_text.h"
#include "abbe/report/customer/customer_report_file.h"
#include "abbe/report/customer/quality_results.h"
#include "abbe/report/pages/evaluation_files.h"
#include "abbe/report/words/evaluation_text.h"
#include "abbe/study/evaluations/customer_evaluation.h"
#include "exit_code.h"
#include "options.h"

namespace abbe {
Subcommand* add_evaluation(Subcommand& evaluate, const std::string& kind, const std::string& description,
                           const std::string& columns, const std::string& renamed, const std::string& example,
                           EvaluationOptions& options) {
  Subcommand* command = evaluate.add_subcommand(kind, description);
  const bool is_study = columns.empty();
  command->footer((is_study ? "" : "Columns of the file:\n" + columns + "\n\n") + "Example:\n" + example);
  command->add_input_file("file", options.file, is_study ? "Study (*.study.toml)" : "Readings (*.csv)")->required();
  command->add_output_folder("-o,--output", options.output,
                             "Results folder to write: evaluation.json, plot.svg, report.html; default: print only");
  command
      ->add_option("--tolerance", options.tolerances,
                   "Largest permitted value of a figure, such as A_um=10; repeatable. Exit code 1 if exceeded")
      ->allow_extra_args(false);
  if (!is_study) add_columns(command, options.columns, renamed);
  command->add_flag("--json", options.json, "Print JSON for programs");
  return command;
}

int finish_evaluation(const EvaluationReport& report, const EvaluationOptions& options,
                      const std::vector<std::pair<std::string, std::string>>& files,
                      const std::function<void(ResultsFolder&)>& write_more) {
  if (!options.output.empty()) {
    ResultsFolder results(options.output);
    for (const auto& [name, contents] : evaluation_files(report)) results.write(name, contents);
    for (const auto& [name, contents] : files) results.write(name, contents);
    if (write_more) write_more(results);
    results.commit();
  }
  if (options.json) {
    fmt::print("{}", json_text(evaluation_json(report)));
  } else {
    fmt::print("{}", evaluation_text(report));
    if (!options.output.empty()) fmt::print("\nresults in {}\n", options.output);
  }
  return report.exceeds_tolerance() ? kNegative : kDone;
}

void add_customer_report_options(Subcommand& command, EvaluationOptions& options) {
  command
      .add_output_file(
          "--customer-report", options.customer_report,
          "Customer report to write, 2 to 4 sheets: *.pdf (printed by Chromium or WeasyPrint) or *.html; *.xml: a "
          "digital calibration certificate")
      ->group("Customer report");
  command.add_output_file("--qif", options.qif, "QIF 3.0 results to write, with the same figures; *.qif")
      ->group("Customer report");
  command
      .add_input_file(
          "--facts", options.facts,
          "Facts for both: a TOML file with the table [report] (customer, machine, tolerances, language, ...)")
      ->group("Customer report");
  command.add_input_file("--before", options.before, "Readings before a correction, for figures before and after")
      ->group("Customer report");
}

void add_expansion(Subcommand& command, std::span<const TestNumber<ExpansionNumbers>> list, ExpansionNumbers& numbers) {
  for (const auto& [option, value, unit, from, to, words] : list)
    command.add_option(option, numbers.*value, words)->check(in_range(from, to))->group("Correction to 20 degC");
}

namespace {

/// Before anything is computed. @throws InputError
void check_customer_options(const EvaluationOptions& options) {
  if (!options.customer_report.empty()) check_customer_report_name(options.customer_report, "--customer-report");
  if (!options.qif.empty()) check_qif_name(options.qif);
  if (!options.customer_report.empty() || !options.qif.empty()) return;
  const char* const lone = !options.facts.empty() ? "--facts" : !options.before.empty() ? "--before" : nullptr;
  if (lone == nullptr) return;
  throw InputError({.field = lone}, "has no effect without a customer report or QIF results",
                   "also --customer-report or --qif");
}

}  // namespace

int run_evaluation(const EvaluationOptions& options,
                   const std::function<TestToEvaluate(const std::string& file)>& test_of) {
  check_customer_options(options);
  ReportFacts facts;
  if (!options.facts.empty()) facts = read_report_facts(options.facts);
  const Evaluation result =
      evaluate_readings({options.file, test_of(options.file), options.tolerances, facts.tolerances});
  PrintedPage printed;
  if (!options.customer_report.empty() || !options.qif.empty()) {
    std::optional<Evaluation> earlier;
    std::vector<std::string> files = {file_name(options.file)};
    if (!options.before.empty()) {
      earlier = evaluate_readings({options.before, test_of(options.before), {}, {}});
      files.insert(files.begin(), file_name(options.before));
    }
    const CustomerReport report = customer_evaluation(facts, result, earlier ? &*earlier : nullptr, files);
    // The report first: it refuses facts that are not enough for a certificate.
    if (!options.customer_report.empty()) printed = write_customer_report(report, options.customer_report);
    if (!options.qif.empty()) write_file_atomically(options.qif, qif_results(report));
  }
  const int code = finish_evaluation(result.report, options, result.files);
  if (!options.json) {
    if (!options.customer_report.empty()) {
      fmt::print("\ncustomer report: {}\n",
                 printed.problem.empty() ? options.customer_report : html_beside(options.customer_report).string());
    }
    if (!options.qif.empty()) fmt::print("\nQIF: {}\n", options.qif);
  }
  require_printed(options.customer_report, html_beside(options.customer_report), printed);
  return result.refused.empty() ? code : static_cast<int>(kNegative);
}

}  // namespace abbe
