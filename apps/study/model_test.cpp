#include "study/model.h"

#include <gtest/gtest.h>

namespace abbe {
namespace {

TEST(Matches, StarStandsForAnyTextAndQuestionMarkForOneCharacter) {
  EXPECT_TRUE(matches("EXX[P2]", "EXX[P2]"));
  EXPECT_TRUE(matches("E?0C", "EX0C"));
  EXPECT_TRUE(matches("*", ""));
  EXPECT_TRUE(matches("tool_*", "tool_X"));
  EXPECT_TRUE(matches("E*[P1]", "EAX[P1]"));
  EXPECT_FALSE(matches("E*[P1]", "EAX[P10]"));
  EXPECT_FALSE(matches("E?X", "EXXX"));
  EXPECT_FALSE(matches("", "E"));
}

}  // namespace
}  // namespace abbe
