#include "abbe/geometry/even_choice.h"

#include <gtest/gtest.h>

#include <vector>

namespace abbe {
namespace {

TEST(EvenChoice, TakesOneOfEachGroupInOrder) {
  for (const Eigen::Index all : {1, 7, 1000, 1001, 1999, 123457}) {
    const EvenChoice choice(all, 100);
    const Eigen::Index every = std::max<Eigen::Index>(1, all / 100);
    ASSERT_EQ(choice.size(), (all + every - 1) / every);
    for (Eigen::Index k = 0; k < choice.size(); ++k) {
      EXPECT_GE(choice[k], k * every);
      EXPECT_LT(choice[k], std::min(all, (k + 1) * every));
    }
  }
  EXPECT_EQ(EvenChoice(0, 10).size(), 0);
}

TEST(EvenChoice, OfFewTakesAll) {
  const Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Random(3, 150);
  EXPECT_EQ(EvenChoice(150, 100).of(points), points);
}

TEST(EvenChoice, DoesNotKeepToAColumnOfARaster) {
  // 1000 rows of 640 points: every 640-th would be the same column.
  const EvenChoice choice(640000, 1000);
  std::vector<int> in_part(8, 0);
  for (Eigen::Index k = 0; k < choice.size(); ++k) ++in_part[static_cast<std::size_t>(choice[k] % 640 / 80)];
  for (const int count : in_part) EXPECT_NEAR(count, 125, 4 * 10.5);
}

}  // namespace
}  // namespace abbe
