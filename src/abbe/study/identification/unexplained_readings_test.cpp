#include "abbe/study/identification/unexplained_readings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "abbe/formats/study/study_file.h"
#include "abbe/geometry/rotation.h"
#include "abbe/instruments/trackers/tracker.h"
#include "abbe/study/campaign.h"
#include "abbe/study/example_file_for_test.h"

namespace abbe {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

/// The first set-up of an example, with simulated readings that a test can spoil.
class Spoiled {
 public:
  explicit Spoiled(const std::string& study)
      : study_(read_study(test::example_file(study))), campaign_(gather_readings(study_)) {}

  InstrumentReadings& readings() { return campaign_.setups.front().readings; }
  std::vector<double>& measured(std::size_t component) { return readings().measured[component]; }
  std::size_t axis(const std::string& name) const {
    std::size_t i = 0;
    while (study_.machine.axes[i].name != name) ++i;
    return i;
  }
  std::vector<UnexplainedReadings> unexplained() const {
    const CampaignSetup& setup = campaign_.setups.front();
    const StartedInstrument started = setup.device->started(study_.machine, setup.readings);
    return judge_readings(study_.machine, *setup.device, setup.readings, started).unexplained;
  }
  /// Of its only station.
  std::vector<std::string> causes() const {
    const std::vector<UnexplainedReadings> found = unexplained();
    EXPECT_THAT(found, SizeIs(1));
    return found.empty() ? std::vector<std::string>{"explained"} : found.front().causes;
  }

 private:
  Study study_;
  Campaign campaign_;
};

constexpr const char* kCartesian = "aguado/aguado.study.toml";
constexpr const char* kPolar = "trunnion/trunnion.study.toml";
constexpr const char* kLengths = "three_axis/tracking-interferometer.study.toml";

TEST(UnexplainedReadings, AreNoneWhereTheMachineExplainsThem) {
  for (const char* const study : {kCartesian, kPolar, kLengths, "closed_loop/closed_loop.study.toml"}) {
    EXPECT_THAT(Spoiled(study).unexplained(), IsEmpty()) << study;
  }
}

TEST(UnexplainedReadings, OfALeftHandedFrame) {
  Spoiled tracker(kCartesian);
  for (double& y : tracker.measured(1)) y = -y;
  EXPECT_THAT(tracker.causes(),
              Contains("the measured coordinates are in a left-handed frame, or two of them are swapped"));
  const UnexplainedReadings place = tracker.unexplained().front();
  EXPECT_LT(place.mended_rms_mm, 2);
  EXPECT_THAT(place.words(), HasSubstr("left-handed frame"));
}

TEST(UnexplainedReadings, OfAnglesThatCountOtherwise) {
  Spoiled clockwise(kPolar);
  for (double& azimuth : clockwise.measured(1)) azimuth = -azimuth;
  EXPECT_THAT(clockwise.causes(), ElementsAre("the azimuth counts clockwise"));

  Spoiled zenith(kPolar);
  for (double& elevation : zenith.measured(2)) elevation = std::numbers::pi / 2 - elevation;
  EXPECT_THAT(zenith.causes(), ElementsAre("the elevation counts from the zenith"));

  Spoiled both(kPolar);
  for (double& azimuth : both.measured(1)) azimuth = -azimuth;
  for (double& elevation : both.measured(2)) elevation = std::numbers::pi / 2 - elevation;
  EXPECT_THAT(both.causes(), ElementsAre("the azimuth counts clockwise, and the elevation counts from the zenith"));

  Spoiled swapped(kPolar);
  std::swap(swapped.measured(1), swapped.measured(2));
  EXPECT_THAT(swapped.causes(), ElementsAre("azimuth and elevation are swapped"));
}

TEST(UnexplainedReadings, InOtherUnits) {
  Spoiled inch(kPolar);
  for (double& range : inch.measured(0)) range /= 25.4;
  EXPECT_THAT(inch.causes(), ElementsAre("the ranges are in inch, not in mm"));

  Spoiled degrees(kPolar);
  for (const std::size_t c : {1, 2}) {
    for (double& angle : degrees.measured(c)) angle *= 180 / std::numbers::pi;
  }
  EXPECT_THAT(degrees.causes(), ElementsAre("azimuth and elevation are in degrees, not in radians"));

  // A total station: gon, clockwise, from the zenith, and metres.
  Spoiled total_station(kPolar);
  for (double& range : total_station.measured(0)) range /= 1000;
  for (double& azimuth : total_station.measured(1)) azimuth = -azimuth / 0.9;
  for (double& elevation : total_station.measured(2)) elevation = (std::numbers::pi / 2 - elevation) / 0.9;
  EXPECT_THAT(total_station.causes(),
              ElementsAre("the ranges are in m, not in mm, and azimuth and elevation are in gon, not in degrees, and "
                          "the azimuth counts clockwise, and the elevation counts from the zenith"));
}

TEST(UnexplainedReadings, OfAxesThatAreMixedUp) {
  Spoiled swapped(kPolar);
  std::swap(swapped.readings().poses.axis[swapped.axis("X")], swapped.readings().poses.axis[swapped.axis("Y")]);
  EXPECT_THAT(swapped.causes(), ElementsAre("the commands of Y and X are swapped"));

  Spoiled reversed(kPolar);
  for (double& c : reversed.readings().poses.axis[reversed.axis("C")]) c = -c;
  EXPECT_THAT(reversed.causes(), ElementsAre("axis C counts in the other direction"));

  Spoiled inch(kPolar);
  for (const char* const name : {"X", "Y", "Z"}) {
    for (double& position : inch.readings().poses.axis[inch.axis(name)]) position /= 25.4;
  }
  EXPECT_THAT(inch.causes(), ElementsAre("the commands of the linear axes are in inch, not in mm"));

  Spoiled both(kPolar);
  std::swap(both.readings().poses.axis[both.axis("X")], both.readings().poses.axis[both.axis("Z")]);
  for (double& azimuth : both.measured(1)) azimuth = -azimuth;
  EXPECT_THAT(both.causes(), ElementsAre("the azimuth counts clockwise, and the commands of X and Z are swapped"));
}

/// Every reading gets the commands of the one `by` later.
void shift_commands(InstrumentReadings& readings, int by) {
  for (std::vector<double>& axis : readings.poses.axis) {
    std::rotate(axis.begin(), by > 0 ? axis.begin() + by : axis.end() + by, axis.end());
  }
}

TEST(UnexplainedReadings, WithTheCommandsOfAnotherRow) {
  Spoiled tracker(kPolar);
  // One reading per pose: else most rows have the commands of their neighbour.
  InstrumentReadings& readings = tracker.readings();
  std::vector<std::size_t> one_per_pose;
  for (std::size_t k = 0; k < readings.count(); ++k) {
    if (k == 0 || readings.poses.pose(k) != readings.poses.pose(k - 1)) one_per_pose.push_back(k);
  }
  ASSERT_GT(one_per_pose.size(), 50U);
  readings = readings.subset(one_per_pose);
  ASSERT_THAT(tracker.unexplained(), IsEmpty());
  shift_commands(readings, 1);
  EXPECT_THAT(tracker.causes(), ElementsAre("each reading has the commands of the row after"));
  shift_commands(readings, -2);
  EXPECT_THAT(tracker.causes(), ElementsAre("each reading has the commands of the row before"));
}

void move_points(InstrumentReadings& readings, std::size_t from, const RigidTransform& motion) {
  for (std::size_t k = from; k < readings.count(); ++k) {
    const Eigen::Vector3d point =
        motion * Eigen::Vector3d(readings.measured[0][k], readings.measured[1][k], readings.measured[2][k]);
    for (int c = 0; c < 3; ++c) readings.measured[static_cast<std::size_t>(c)][k] = point[c];
  }
}

TEST(UnexplainedReadings, OfAStationThatMoved) {
  Spoiled once(kCartesian);
  const std::size_t count = once.readings().count();
  ASSERT_LE(count, 2000U);
  move_points(once.readings(), count / 2, {rotation_from_vector({0.1, 0.2, -0.05}), {120, -40, 30}});
  const std::vector<std::string> causes = once.causes();
  ASSERT_THAT(causes, SizeIs(1));
  EXPECT_THAT(causes[0], HasSubstr("station moved after reading "));
  const double at = std::stod(causes[0].substr(causes[0].rfind("reading ") + 8));
  EXPECT_NEAR(at, static_cast<double>(count / 2) - 1, 0.02 * static_cast<double>(count)) << causes[0];

  Spoiled twice(kCartesian);
  move_points(twice.readings(), count / 3, {rotation_from_vector({0, 0.2, 0}), {80, 0, 0}});
  move_points(twice.readings(), 2 * count / 3, {rotation_from_vector({0, 0, 0.3}), {0, 90, 0}});
  EXPECT_THAT(twice.causes(), ElementsAre(testing::MatchesRegex("station moved after reading [0-9]+ and after "
                                                                "reading [0-9]+")));
}

TEST(UnexplainedReadings, OfATrackingInterferometer) {
  Spoiled inch(kLengths);
  for (double& length : inch.measured(0)) length /= 25.4;
  for (const UnexplainedReadings& place : inch.unexplained()) {
    EXPECT_THAT(place.causes, Contains("the lengths are in inch, not in mm")) << place.words();
  }
  EXPECT_THAT(inch.unexplained(), testing::Not(IsEmpty()));

  Spoiled reversed(kLengths);
  for (double& length : reversed.measured(0)) length = -length;
  for (const UnexplainedReadings& place : reversed.unexplained()) {
    EXPECT_THAT(place.causes, Contains("the lengths grow towards the interferometer")) << place.words();
  }
  EXPECT_THAT(reversed.unexplained(), testing::Not(IsEmpty()));
}

TEST(UnexplainedReadings, ThatNothingExplainsHaveNoCause) {
  Spoiled mixed(kPolar);
  std::vector<double>& azimuth = mixed.measured(1);
  for (std::size_t k = 0; k < azimuth.size(); ++k) azimuth[k] = std::fmod(0.7 * static_cast<double>(k * k), 3.0);
  const std::vector<UnexplainedReadings> found = mixed.unexplained();
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_THAT(found[0].causes, IsEmpty());
  EXPECT_THAT(found[0].words(), HasSubstr("none of the usual mistakes would explain that"));
}

TEST(UnexplainedReadings, OfFewReadingsArePassedOver) {
  for (const std::size_t count : {1U, 2U, 3U, 5U, 6U, 8U}) {
    Spoiled few(kPolar);
    std::vector<std::size_t> kept;
    for (std::size_t k = 0; k < count; ++k) kept.push_back(k * 7 % few.readings().count());
    few.readings() = few.readings().subset(kept);
    EXPECT_THAT(few.unexplained(), IsEmpty()) << count;
    for (double& azimuth : few.measured(1)) azimuth = -azimuth;
    if (count < 6) {
      EXPECT_THAT(few.unexplained(), IsEmpty()) << count;
    } else {
      EXPECT_THAT(few.causes(), Contains("the azimuth counts clockwise")) << count;
    }
  }
}

}  // namespace
}  // namespace abbe
