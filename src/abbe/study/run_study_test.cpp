#include "abbe/study/run_study.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

namespace abbe {
namespace {

Study dials() { return read_study(ABBE_SOURCE_DIR "/examples/three_axis/dials.study.toml"); }

TEST(RunStudy, TellsOfEveryStepInOrderAndMapsLast) {
  const Study study = dials();
  std::vector<StudyStep> steps;
  const StudyResult result = run_study(study, {.progress = [&](StudyStep step, std::size_t done, std::size_t total) {
                                         EXPECT_LE(done, total);
                                         if (steps.empty() || steps.back() != step) steps.push_back(step);
                                       }});
  EXPECT_EQ(steps, (std::vector{StudyStep::gather, StudyStep::identify, StudyStep::map}));
  EXPECT_TRUE(result.usable()) << result.identification.message;
  EXPECT_TRUE(result.map && result.unseen && result.volumetric);
  EXPECT_FALSE(says_no(study, result));
  EXPECT_NE(study_text(study, result, nullptr).find("identification: converged"), std::string::npos);
}

TEST(RunStudy, TheResultDoesNotNeedTheStudyThatItIsOf) {
  StudyResult result;
  {
    const Study passing = dials();
    result = run_study(passing, {.map = false});
  }
  EXPECT_FALSE(result.map);
  const Study study = dials();
  EXPECT_EQ(study_text(study, result, nullptr), study_text(study, run_study(study, {.map = false}), nullptr));
}

TEST(RunStudy, ListsEveryParameterWithItsUncertainty) {
  const StudyResult result = run_study(dials(), {.map = false});
  ASSERT_FALSE(result.identification.parameters.empty());
  const std::string text = parameters_text(result);
  EXPECT_EQ(static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n')),
            1 + result.identification.parameters.size());
  const auto& first = result.identification.parameters.front();
  char line[200];
  std::snprintf(line, sizeof line, "\n%-24s %16.4f %16.4f %s\n", first.name.c_str(),
                (first.is_angle ? 1e6 : 1e3) * result.identification.estimates[0],
                (first.is_angle ? 1e6 : 1e3) * result.identification.standard_uncertainties[0],
                first.is_angle ? "urad" : "um");
  EXPECT_NE(text.find(line), std::string::npos) << line << text;
}

TEST(RunStudy, StopsInEveryStep) {
  const Study study = dials();
  for (const StudyStep last : {StudyStep::gather, StudyStep::identify, StudyStep::map}) {
    std::stop_source source;
    RunOptions options;
    options.stop = source.get_token();
    options.progress = [&](StudyStep step, std::size_t, std::size_t) {
      EXPECT_LE(step, last);
      if (step == last) source.request_stop();
    };
    EXPECT_THROW(run_study(study, options), Stopped) << step_words(study, last);
  }
}

}  // namespace
}  // namespace abbe
