#include "study_outcome.h"

#include "abbe/study/identification/trust.h"
#include "abbe/study/report/summary.h"
#include "exit_code.h"
#include "messages.h"

namespace abbe {

void tell_distrust(const Study& study, const StudyResult& result) {
  if (!result.usable() && says_no(study, result)) tell("abbe: {}\n", study_verdict(study, result));
  for (const Distrust& reason : result.distrusted) tell("abbe: not to be trusted: {}\n", reason.text);
  if (result.distrusted.empty()) return;
  tell("abbe: {}\n", result.misfit_accepted
                         ? "accepted by --accept-misfit, as its errors file says"
                         : "its errors are marked and abbe compensate refuses them; once the cause is known and "
                           "harmless, --accept-misfit accepts the result");
}

int study_exit_code(const Study& study, const StudyResult& result) {
  return says_no(study, result) ? kNegative : kDone;
}

}  // namespace abbe
