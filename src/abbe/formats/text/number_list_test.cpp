#include "abbe/formats/text/number_list.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "abbe/formats/text/message_of.h"

namespace abbe {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(NumberList, NumbersBetweenCommas) {
  EXPECT_THAT(parse_number_list("12,-30.5,1e-3", "--radius", "mm"), ElementsAre(12, -30.5, 1e-3));
  EXPECT_THAT(parse_number_list("", "--radius", "mm"), IsEmpty());
  for (const char* const text : {"12,,3", "1;2", "1, 2", "nan", "12,x"}) {
    EXPECT_THAT(message_of([&] { parse_number_list(text, "--radius", "numbers of mm"); }),
                HasSubstr("is not a number; expected numbers of mm"))
        << text;
  }
}

TEST(NumberList, ADirectionHasThreeNumbers) {
  EXPECT_EQ(parse_direction("0,-2,1", "--direction"), Eigen::Vector3d(0, -2, 1));
  for (const char* const text : {"", "1,2", "1,2,3,4"}) {
    EXPECT_THAT(message_of([&] { parse_direction(text, "--direction"); }), HasSubstr("is not a direction")) << text;
  }
}

}  // namespace
}  // namespace abbe
