#include "abbe/study/run_study.h"

#include "abbe/study/customer/customer_study.h"
#include "abbe/study/report/advice.h"
#include "abbe/study/study_steps.h"

namespace abbe {
namespace {

/// Progress of one step; asks at every turn whether to go on.
ProgressCallback progress_of(const RunOptions& options, StudyStep step) {
  return [&options, step](std::size_t done, std::size_t total) {
    stop_if_asked(options.stop);
    if (options.progress) options.progress(step, done, total);
  };
}

}  // namespace

const char* step_words(const Study& study, StudyStep step) {
  switch (step) {
    case StudyStep::gather:
      return study.simulation ? "simulating readings" : "reading measurements";
    case StudyStep::identify:
      return "identifying";
    case StudyStep::map:
      return "mapping the volumetric error";
  }
  return "";
}

StudyResult run_study(const Study& study, const RunOptions& options) {
  check_customer_report(study);
  StudyResult result;
  if (study.report.before) result.before = read_earlier_result(study);
  result.misfit_accepted = options.accept_misfit;
  const auto begin = [&](StudyStep step) {
    ProgressCallback progress = progress_of(options, step);
    progress(0, 1);
    return progress;
  };
  result.campaign = gather_readings(study, {.progress = begin(StudyStep::gather), .stop = options.stop});
  if (!study.identification) {
    // Simulated readings are as good as the study; measured ones can contradict it.
    if (!study.simulation) find_start_values(study.machine, result.campaign);
    result.warnings = result.campaign.warnings;
    return result;
  }
  identify_study(study, result,
                 {.progress = begin(StudyStep::identify),
                  .stop = options.stop,
                  .summation = options.summation,
                  .work = options.work,
                  .advice = options.advice});
  if (!result.usable()) {
    judge_trust(study, result);
    return result;
  }
  result.unseen = evaluate_unseen(study, result);
  tell_datum_apart(result, *result.unseen);
  judge_trust(study, result);
  if (options.map) result.map = map_study(study, result, begin(StudyStep::map), options.work);
  return result;
}

}  // namespace abbe
