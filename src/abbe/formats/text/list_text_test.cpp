#include "abbe/formats/text/list_text.h"

#include <gtest/gtest.h>

namespace abbe {
namespace {

TEST(ListText, OneIsCountedInTheSingular) {
  EXPECT_EQ(counted(0, "face is", "faces are"), "0 faces are");
  EXPECT_EQ(counted(1, "face is", "faces are"), "1 face is");
  EXPECT_EQ(counted(2, "face is", "faces are"), "2 faces are");
}

TEST(ListText, LongListsEndWithTheNumberOfTheRest) {
  EXPECT_EQ(first_few({}, "; "), "");
  EXPECT_EQ(first_few({"a"}, "; "), "a");
  EXPECT_EQ(first_few({"a", "b", "c", "d", "e"}, ", "), "a, b, c, d, e");
  EXPECT_EQ(first_few({"a", "b", "c", "d", "e", "f", "g"}, "; "), "a; b; c; d; e; and 2 more");
}

}  // namespace
}  // namespace abbe
