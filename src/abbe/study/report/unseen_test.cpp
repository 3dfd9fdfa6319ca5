#include "abbe/study/report/unseen.h"

#include <gtest/gtest.h>

#include <string>

#include "abbe/formats/study/study_file.h"
#include "abbe/study/study_steps.h"

namespace abbe {
namespace {

/// Figures at poses that took no part, of an example taken as if its readings had been measured.
UnseenPoses held_out(const std::string& example) {
  const Study study = read_study(std::string(ABBE_SOURCE_DIR "/examples/three_axis/") + example + ".study.toml");
  StudyResult result;
  result.campaign = gather_readings(study);
  identify_study(study, result);
  EXPECT_TRUE(result.usable()) << result.identification.message;
  result.campaign.truth.reset();
  return evaluate_unseen(study, result);
}

TEST(UnseenPoses, OfInstrumentsHaveAsManyNumbersAsTheirLengths) {
  // Lengths and two straightnesses of the six components, no angles; the diagonals have a length alone.
  const UnseenPoses six = held_out("six-component-laser");
  ASSERT_GT(six.after.size(), 0u);
  EXPECT_GT(six.numbers, 2 * six.after.size());
  EXPECT_LT(six.numbers, 3 * six.after.size());
  const UnseenPoses one = held_out("tracking-interferometer");
  ASSERT_GT(one.after.size(), 0u);
  EXPECT_EQ(one.numbers, one.after.size());
  EXPECT_EQ(one.before.size(), one.after.size());
}

}  // namespace
}  // namespace abbe
