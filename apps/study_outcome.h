#pragma once

#include "abbe/study/study_result.h"

namespace abbe {

/// Tells on standard error why there is no result, or the reasons not to trust it.
void tell_distrust(const Study& study, const StudyResult& result);

/// What the process returns after this study: kDone only for a result that is usable and trusted or accepted.
int study_exit_code(const Study& study, const StudyResult& result);

}  // namespace abbe
