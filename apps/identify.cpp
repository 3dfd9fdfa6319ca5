#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "abbe/formats/files/existing_output.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/json_text.h"
#include "abbe/study/report/report_parameters.h"
#include "abbe/study/report/summary.h"
#include "abbe/study/run_study.h"
#include "command.h"
#include "exit_code.h"
#include "messages.h"
#include "options.h"
#include "progress.h"
#include "study_outcome.h"

namespace abbe {

void add_identify_command(CommandLine& line) {
  struct Options {
    std::string study, output;
    bool json = false, parameters = false, accept_misfit = false;
  };
  auto options = std::make_shared<Options>();
  Subcommand* command = line.add("identify", "Identify the errors of a study's machine, without maps and report",
                                 "  abbe identify examples/aguado/aguado.study.toml -o aguado.errors.toml\n"
                                 "  abbe identify examples/aguado/aguado.study.toml --parameters");
  command->add_input_file("study", options->study, "Study file (*.study.toml) with an [identify] table")->required();
  command->add_output_file("-o,--output", options->output,
                           "Errors file to write (*.errors.toml), covariance beside it");
  command->add_flag("--parameters", options->parameters, "List every parameter with its standard uncertainty");
  command->add_flag("--json", options->json, "Print JSON for programs");
  command->add_flag("--accept-misfit", options->accept_misfit,
                    "Exit with code 0 and allow the errors to be used, even if the result is not to be trusted");
  command->callback([&line, options] {
    line.share([options](ProcessGroup* processes) -> int {
      const Study study = read_study(options->study);
      if (!study.identification)
        throw InputError({.file = options->study}, "nothing to identify", "an [identify] table");
      if (!options->output.empty()) refuse_existing_output(covariance_beside(options->output));
      StepProgress progress;
      SharedWork work(processes, options->output, tell_sentence);
      const StudyResult result =
          run_study(study, {.accept_misfit = options->accept_misfit,
                            .map = false,
                            .progress = [&](StudyStep step, std::size_t done,
                                            std::size_t total) { progress.show(step_words(study, step), done, total); },
                            .summation = work.summation(),
                            .work = work.driver()});
      progress.end();
      if (!work.is_first()) return kDone;
      if (result.usable() && !options->output.empty()) {
        ErrorsFile file = identified_errors_file(study, result);
        file.provenance = {{"study", study.name}, {"method", "abbe identify"}};
        write_errors(options->output, study.machine, file);
      }
      work.done();
      if (options->json) {
        nlohmann::ordered_json json = study_summary(study, result);
        if (result.usable())
          json["parameter_table"] = report_parameters(study.machine, result, nullptr, ScalesIn::mm_and_mrad);
        fmt::print("{}", json_text(json));
        tell_distrust(study, result);
        return study_exit_code(study, result);
      }
      fmt::print("{}", study_text(study, result, options->parameters ? nullptr : "--parameters"));
      if (options->parameters && result.usable()) fmt::print("\n{}", parameters_text(result));
      if (!options->output.empty() && result.usable()) fmt::print("\n{} written\n", options->output);
      tell_distrust(study, result);
      return study_exit_code(study, result);
    });
  });
}

}  // namespace abbe
