#include "abbe/formats/readings/planned_touches.h"

#include <gmock/gmock.h>

#include <functional>

#include "abbe/formats/text/input_error.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/machine/chain.h"

namespace abbe {
namespace {

using testing::HasSubstr;

Machine turning_mill() { return parse_chain("w C' b Z X t").machine; }

std::vector<PlannedTouch> two_touches() {
  return {{{90 * kDegree, 20, -5}, {0, 0, -1}, 5, "a", "reading 1, touch 1"},
          {{-30 * kDegree, 22.5, 7}, {-1, 0, 0}, 5, "a", "reading 2, touch 1"}};
}

constexpr const char* kLog =
    "-5.012000 0.000000 20.250000 0.000000 0.000000 90.000000 0.000000 0.000000 0.000000\n"
    "7.000000 0.000000 22.500001 0.000000 0.000000 -30.000000 0.000000 0.000000 0.000000\n";

std::string readings_of(const std::string& log, const std::vector<PlannedTouch>& touches = two_touches()) {
  return probed_touches_csv(turning_mill(), touches, "touches.csv", log, "log.txt");
}

std::string message_of_log(const std::string& log) {
  try {
    readings_of(log);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(PlannedTouches, AreReadAsTheyWereWritten) {
  const std::vector<PlannedTouch> touches =
      parse_planned_touches(planned_touches_csv(turning_mill(), two_touches()), "t.csv", turning_mill());
  ASSERT_EQ(touches.size(), 2U);
  EXPECT_NEAR(touches[1].pose[0], -30 * kDegree, 1e-15);
  EXPECT_EQ(touches[1].pose[1], 22.5);
  EXPECT_EQ(touches[1].approach, Eigen::Vector3d(-1, 0, 0));
  EXPECT_EQ(touches[1].within, 5);
  EXPECT_EQ(touches[1].item, "a");
  EXPECT_EQ(touches[0].point, "reading 1, touch 1");
}

TEST(PlannedTouches, MakeReadingsOfALog) {
  EXPECT_EQ(readings_of(kLog),
            "C_deg,Z_mm,X_mm,item,approach_x_mm,approach_y_mm,approach_z_mm,travel_mm,point\n"
            "90.000000,20.250000,-5.012000,a,0,0,-1,0,\"reading 1, touch 1\"\n"
            "-30.000000,22.500001,7.000000,a,-1,0,0,0,\"reading 2, touch 1\"\n");
}

TEST(PlannedTouches, RefuseALogThatIsNotTheirs) {
  std::string log = kLog;
  EXPECT_THAT(message_of_log(log + log), HasSubstr("log.txt:3: there are more touches"));
  EXPECT_THAT(message_of_log(log.substr(0, log.find('\n') + 1)), HasSubstr("1 touch is missing at its end"));
  EXPECT_THAT(message_of_log(log.substr(log.find('\n') + 1)), HasSubstr("log.txt:1: axis C is -120.0000 degrees"));
  EXPECT_THAT(message_of_log("1 2 3\n"), HasSubstr("the line has 3 fields"));
  log.replace(0, 9, "-9.912000");
  log.replace(log.find("20.25"), 5, "22.25");
  EXPECT_THAT(message_of_log(log), HasSubstr("log.txt:1: it is 5.403 mm from where the probe should touch"));
  EXPECT_THAT(message_of_log("a b c d e f g h i\n"), HasSubstr("log.txt:1"));
}

}  // namespace
}  // namespace abbe
