#include <abbe/study/run_study.h>

#include <cstdio>

int main(int /*argc*/, char** arguments) {
  abbe::Study study = abbe::read_study(arguments[1]);
  study.output = arguments[2];
  const abbe::StudyResult result = abbe::run_study(study);
  abbe::write_results(study, result);
  std::fputs(abbe::study_text(study, result, nullptr).c_str(), stdout);
  return abbe::says_no(study, result) ? 1 : 0;
}
