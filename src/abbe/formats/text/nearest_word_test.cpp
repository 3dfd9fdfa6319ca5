#include "abbe/formats/text/nearest_word.h"

#include <gtest/gtest.h>

namespace abbe {
namespace {

TEST(NearestWord, CountsInsertedRemovedReplacedAndSwappedLetters) {
  EXPECT_EQ(spelling_distance("", ""), 0U);
  EXPECT_EQ(spelling_distance("verify", "verify"), 0U);
  EXPECT_EQ(spelling_distance("veriffy", "verify"), 1U);
  EXPECT_EQ(spelling_distance("vrify", "verify"), 1U);
  EXPECT_EQ(spelling_distance("varify", "verify"), 1U);
  EXPECT_EQ(spelling_distance("evrify", "verify"), 1U);
  EXPECT_EQ(spelling_distance("map", ""), 3U);
}

TEST(NearestWord, IsTheOneThatWasProbablyMeant) {
  const std::vector<std::string> words = {"run", "map", "plan", "path", "compensate", "--json", "--force"};
  EXPECT_EQ(nearest_word("compnesate", words), "compensate");
  EXPECT_EQ(nearest_word("--jsn", words), "--json");
  EXPECT_EQ(nearest_word("rnu", words), "run");
  EXPECT_EQ(nearest_word("report", words), std::nullopt) << "too far from all";
  EXPECT_EQ(nearest_word("pla", {"plan", "play"}), std::nullopt) << "as near to both";
  EXPECT_EQ(nearest_word("x", {}), std::nullopt);
}

}  // namespace
}  // namespace abbe
