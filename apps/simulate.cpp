#include <fmt/format.h>

#include "abbe/formats/files/results_folder.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/study/study_file.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/study/campaign.h"
#include "abbe/study/report/results.h"
#include "command.h"
#include "exit_code.h"
#include "options.h"
#include "progress.h"

namespace abbe {

void add_simulate_command(CommandLine& line) {
  struct Options {
    std::string study, output;
  };
  auto options = std::make_shared<Options>();
  Subcommand* command =
      line.add("simulate", "Simulate the readings of a study and write them as measurement files",
               "  abbe simulate examples/aguado/aguado.study.toml -o readings\n\n"
               "Writes SETUP.csv for every set-up and truth.errors.toml with the errors behind them.");
  command->add_input_file("study", options->study, "Study file (*.study.toml) with a [simulate]")->required();
  command->add_output_folder("-o,--output", options->output, "Folder to write")->required();
  command->callback([&line, options] {
    line.run = [options]() -> int {
      const Study study = read_study(options->study);
      if (!study.simulation) {
        throw InputError({.file = options->study}, "the study reads its measurements from files", "a [simulate] table");
      }
      Campaign campaign;
      {
        Progress progress("simulating readings");
        campaign = gather_readings(study, {.progress = progress.callback()});
      }
      ResultsFolder folder(options->output);
      for (const CampaignSetup& setup : campaign.setups) {
        folder.write(setup.name + ".csv", setup.readings_text(study.machine));
        fmt::print("{}/{}.csv  {} readings", options->output, setup.name, setup.reading_count());
        if (!setup.outliers.empty()) fmt::print(", {} of them gross errors", setup.outliers.size());
        if (setup.hidden > 0) fmt::print("; {} without a line of sight left out", setup.hidden);
        fmt::print("\n");
      }
      const ErrorsFile truth{
          .errors = *campaign.truth, .covariance = {}, .provenance = {{"method", kTruthOfSimulation}}};
      folder.write("truth.errors.toml", errors_text(study.machine, truth));
      folder.commit();
      fmt::print("{}/truth.errors.toml  {} parameters\n", options->output, truth.errors.parameter_count());
      return kDone;
    };
  });
}

}  // namespace abbe
