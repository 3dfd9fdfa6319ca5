#include "verify_readings.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "abbe/formats/files/results_files.h"
#include "abbe/formats/files/results_folder.h"
#include "abbe/formats/files/text_file.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/machine/state_option.h"
#include "abbe/formats/text/json_text.h"
#include "abbe/report/words/evaluation_text.h"
#include "abbe/study/run_study.h"
#include "abbe/study/verification/verified_readings.h"
#include "errors_for_use.h"
#include "exit_code.h"
#include "progress.h"
#include "uncovered_poses.h"

namespace abbe {

int run_verify_readings(const VerifyReadingsOptions& options) {
  ReadingsToVerify request;
  request.study = read_study(options.study);
  const std::string errors = file_or_of_results(options.files.errors, options.files.results, "errors.toml", "--errors");
  request.errors_file = errors;
  request.identified = read_errors_and_values(errors, request.study.machine, options.files.states, request.states);
  tell_distrusted(errors, request.identified);
  request.least_reduction = options.least_reduction;
  request.largest_ratio = options.largest_ratio;
  StepProgress progress;
  const VerifiedReadings result = verify_readings(request, {.progress = [&](std::size_t done, std::size_t total) {
                                                    progress.show("fitting the set-ups", done, total);
                                                  }});
  progress.end();
  if (!options.page.empty()) write_file_atomically(options.page, evaluation_page(result.report));
  if (options.json) {
    fmt::print("{}", json_text(evaluation_json(result.report)));
  } else {
    fmt::print("{}", evaluation_text(result.report));
    if (!options.page.empty()) fmt::print("\npage: {}\n", options.page);
  }
  const int left_out = tell_left_out(result.left_out(), options.accept_uncovered);
  return result.says_no() ? kNegative : left_out;
}

}  // namespace abbe
