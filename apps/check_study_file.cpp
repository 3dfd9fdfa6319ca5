#include "check_study_file.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "abbe/formats/text/json_text.h"
#include "abbe/study/run_study.h"
#include "abbe/study/study_check.h"
#include "exit_code.h"
#include "progress.h"

namespace abbe {

int check_study_file(const std::string& file, bool json) {
  const Study study = read_study(file);
  // The line of the progress is gone before anything is printed.
  const StudyCheck check = check_study(study, {.progress = Progress(step_words(study, StudyStep::gather)).callback()});
  fmt::print("{}", json ? json_text(study_check_json(study, check)) : study_check_text(study, check));
  return check.is_explained() ? kDone : kNegative;
}

}  // namespace abbe
