#include <fmt/format.h>

#include <optional>

#include "abbe/formats/files/results_folder.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/report/customer/customer_report_file.h"
#include "abbe/study/customer/customer_study.h"
#include "abbe/study/report/results.h"
#include "abbe/study/report/summary.h"
#include "abbe/study/run_study.h"
#include "command.h"
#include "exit_code.h"
#include "messages.h"
#include "options.h"
#include "progress.h"
#include "study_outcome.h"
#include "uncovered_poses.h"

namespace abbe {

void add_run_command(CommandLine& line) {
  struct Options {
    std::string study, output, before, qif;
    bool accept_uncovered = false, accept_misfit = false, all_values = false, json = false, pdf = false;
  };
  auto options = std::make_shared<Options>();
  Subcommand* command =
      line.add("run", "Run a whole study: simulate or read, identify, verify, map, report",
               "  abbe run examples/aguado/aguado.study.toml\n"
               "  abbe run examples/three_axis/level-and-autocollimator.study.toml -o results/level --json\n"
               "  abbe run examples/customer_report/mill.study.toml -o results/mill --pdf");
  command->add_input_file("study", options->study, "Study file (*.study.toml)")->required();
  command->add_output_folder("-o,--output", options->output, "Results folder (default: as in the study)");
  command->add_flag("--accept-uncovered", options->accept_uncovered, kAcceptUncoveredWords);
  command->add_flag("--all-values", options->all_values,
                    "Print every identified value, outlier and direction that the readings do not determine");
  command->add_flag("--json", options->json, "Print the summary as JSON for programs");
  command->add_flag("--pdf", options->pdf,
                    "Also write the customer report as PDF; [report] of the study states its facts");
  command->add_output_file("--qif", options->qif,
                           "QIF 3.0 results to write, with the figures of the customer report; *.qif");
  command->add_option("--before", options->before,
                      "Results of the same machine before its correction, for the customer report: a results folder "
                      "of abbe run, or an errors file");
  command->add_flag("--accept-misfit", options->accept_misfit,
                    "Exit with code 0 and allow the errors to be used, even if the result is not to be trusted");
  command->callback([&line, options] {
    line.share([options](ProcessGroup* processes) -> int {
      Study study = read_study(options->study);
      if (!options->output.empty()) study.output = options->output;
      if (!options->before.empty()) study.report.before = options->before;
      SharedWork work(processes, study.output.string(), tell_sentence);
      if (work.is_first()) check_results_folder(study.output);
      if (!options->qif.empty()) check_qif_name(options->qif);
      if ((options->pdf || !options->qif.empty()) && !study.report.facts) {
        throw InputError({.file = options->study, .field = "report"}, "states no facts of a customer report",
                         fmt::format("customer, machine, date and others, or no {}", options->pdf ? "--pdf" : "--qif"));
      }
      StepProgress progress;
      const StudyResult result =
          run_study(study, {.accept_misfit = options->accept_misfit,
                            .progress = [&](StudyStep step, std::size_t done,
                                            std::size_t total) { progress.show(step_words(study, step), done, total); },
                            .summation = work.summation(),
                            .work = work.driver()});
      progress.end();
      ReadyFiles ready;
      if (result.usable()) ready.residuals_csv = residuals_csv(study, result, work.driver());
      if (!work.is_first()) return kDone;
      PrintedPage printed;
      std::optional<CustomerReport> customer;
      if (study.report.facts) customer = study_customer_report(study, result);
      if (options->pdf) printed = printed_customer_report(*customer);
      ready.customer_pdf = printed.pdf;
      const std::string summary = write_results(study, result, ready);
      work.done();
      if (!options->qif.empty()) write_file_atomically(options->qif, study_qif_results(study, result));
      if (options->json) {
        fmt::print("{}", summary);
      } else {
        fmt::print("{}", study_text(study, result, options->all_values ? nullptr : "--all-values, or summary.json"));
        fmt::print("\nresults in {}\n", study.output.string());
        if (study.report.page) fmt::print("report:    {}\n", (study.output / "report.html").string());
        if (customer) {
          const char* const name = printed.pdf.empty() ? "customer-report.html" : "customer-report.pdf";
          fmt::print("customer:  {}\n", (study.output / name).string());
        }
        if (!options->qif.empty()) fmt::print("QIF:       {}\n", options->qif);
      }
      tell_distrust(study, result);
      int code = study_exit_code(study, result);
      if (result.map) {
        const int uncovered = tell_left_out(result.map->left_out(), options->accept_uncovered);
        if (code == kDone) code = uncovered;
      }
      const std::string exceeded = customer ? exceeded_tolerances(*customer) : std::string();
      if (!exceeded.empty()) {
        tell("abbe: out of tolerance: {}\n", exceeded);
        if (code == kDone) code = kNegative;
      }
      require_printed(study.output / "customer-report.pdf", study.output / "customer-report.html", printed);
      return code;
    });
  });
}

}  // namespace abbe
