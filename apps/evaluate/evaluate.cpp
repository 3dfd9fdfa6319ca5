#include "evaluate/evaluate.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "abbe/formats/files/results_folder.h"
#include "abbe/formats/text/json_text.h"
#include "abbe/report/pages/evaluation_files.h"
#include "abbe/report/words/evaluation_text.h"
#include "exit_code.h"
#include "options.h"

namespace abbe {
Subcommand* add_evaluation(Subcommand& evaluate, const std::string& kind, const std::string& description,
                           const std::string& columns, const std::string& renamed, const std::string& example,
                           EvaluationOptions& options) {
  Subcommand* command = evaluate.add_subcommand(kind, description);
  command->footer("Columns of the file:\n" + columns + "\n\nExample:\n" + example);
  command->add_input_file("file", options.file, "Readings (*.csv)")->required();
  command->add_output_folder("-o,--output", options.output,
                             "Results folder to write: evaluation.json, plot.svg, report.html; default: print only");
  command
      ->add_option("--tolerance", options.tolerances,
                   "Largest permitted value of a figure, such as A_um=10; repeatable. Exit code 1 if exceeded")
      ->allow_extra_args(false);
  add_columns(command, options.columns, renamed);
  command->add_flag("--json", options.json, "Print JSON for programs");
  return command;
}

int finish_evaluation(const EvaluationReport& report, const EvaluationOptions& options,
                      const std::vector<std::pair<std::string, std::string>>& files) {
  if (!options.output.empty()) {
    ResultsFolder folder(options.output);
    for (const auto& [name, contents] : evaluation_files(report)) folder.write(name, contents);
    for (const auto& [name, contents] : files) folder.write(name, contents);
    folder.commit();
  }
  if (options.json) {
    fmt::print("{}", json_text(evaluation_json(report)));
  } else {
    fmt::print("{}", evaluation_text(report));
    if (!options.output.empty()) fmt::print("\nresults in {}\n", options.output);
  }
  return report.exceeds_tolerance() ? kNegative : kDone;
}

int run_evaluation(TestToEvaluate test, const EvaluationOptions& options) {
  const Evaluation result = evaluate_readings({options.file, std::move(test), options.tolerances});
  const int code = finish_evaluation(result.report, options, result.files);
  return result.refused.empty() ? code : static_cast<int>(kNegative);
}

}  // namespace abbe
