#include "abbe/formats/readings/outermost_readings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "abbe/formats/readings/readings_bytes.h"
#include "abbe/geometry/numbered_work.h"

namespace abbe {
namespace {

using testing::ElementsAre;

InstrumentReadings readings_of(const std::vector<double>& x, const std::vector<double>& known,
                               const std::vector<std::uint16_t>& items) {
  InstrumentReadings readings;
  readings.poses.axis = {x};
  readings.inputs = {known};
  readings.item = items;
  return readings;
}

TEST(OutermostReadings, StandAtTheEndsOfEveryColumnAndAreTheFirstOfEveryItem) {
  const InstrumentReadings readings = readings_of({3, -5, 7, 7, -5}, {1, 1, 1, 2, 0}, {0, 0, 0, 2, 2});
  OutermostReadings found;
  found.take(readings, 100);
  // x: -5 at 101 and 7 at 102, the first of equal ones; known number: 0 at 104, 2 at 103; items: 100, 103.
  EXPECT_THAT(found.readings(), ElementsAre(100, 101, 102, 103, 104));
}

TEST(OutermostReadings, DoNotDependOnTheOrderInWhichPartsAreTaken) {
  const InstrumentReadings first = readings_of({0, 1, 9}, {5, 5, 5}, {0, 1, 1}),
                           second = readings_of({9, -1, 1}, {5, 5, 5}, {1, 3, 0});
  OutermostReadings forwards, backwards, merged, of_first, of_second;
  forwards.take(first, 0);
  forwards.take(second, 3);
  backwards.take(second, 3);
  backwards.take(first, 0);
  of_first.take(first, 0);
  of_second.take(second, 3);
  merged.take(of_second);
  merged.take(of_first);
  EXPECT_THAT(forwards.readings(), ElementsAre(0, 1, 2, 4));
  EXPECT_EQ(backwards.readings(), forwards.readings());
  EXPECT_EQ(merged.readings(), forwards.readings());
}

TEST(OutermostReadings, PassOverWhatIsNoNumber) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  OutermostReadings found;
  found.take(readings_of({kNone, 2, kNone, 1}, {0, 0, 0, 0}, {0, 0, 0, 0}), 0);
  EXPECT_THAT(found.readings(), ElementsAre(0, 1, 3));
}

TEST(OutermostReadings, AreTheSameFromTheirBytes) {
  OutermostReadings found;
  found.take(readings_of({3, -5, 7, 7, -5}, {1, 1, 1, 2, 0}, {0, 0, 0, 2, 2}), (std::size_t{1} << 40) + 7);
  std::vector<std::byte> bytes;
  found.pack(bytes);
  std::span<const std::byte> left = bytes;
  EXPECT_EQ(OutermostReadings::unpack(left).readings(), found.readings());
  EXPECT_TRUE(left.empty());
  for (const std::size_t size : {std::size_t{0}, std::size_t{8}, bytes.size() - 1}) {
    left = std::span(bytes).first(size);
    EXPECT_THROW(OutermostReadings::unpack(left), WorkError) << size;
  }
}

TEST(ReadingsBytes, HoldEveryColumn) {
  InstrumentReadings readings;
  readings.poses.axis = {{1, 2, 3}, {-1, 0.1, 1e300}};
  readings.poses.approach = {{1, -1, 0}, {0, 0, 1}};
  readings.poses.state = {{}, {20, 21, 22}};
  readings.item = {0, 7, 65535};
  readings.inputs = {{4, 5, 6}};
  readings.measured = {{7, 8, 9}, {10, 11, 12}};
  readings.covariance = {{1, 1, 1}, {2, 2, 2}, {0, 0, 0}};
  readings.time_s = {0, 0.5, 1};
  readings.point_name = {"a", "", "ö, \"3\""};
  std::vector<std::byte> bytes{std::byte{42}};
  pack_readings(readings, bytes);
  pack_readings(readings.subset({2}), bytes);
  std::span<const std::byte> left = std::span(bytes).subspan(1);
  for (const std::vector<std::size_t>& some : {std::vector<std::size_t>{0, 1, 2}, {2}}) {
    const InstrumentReadings expected = readings.subset(some), found = unpack_readings(left);
    EXPECT_EQ(found.poses.axis, expected.poses.axis);
    EXPECT_EQ(found.poses.approach, expected.poses.approach);
    EXPECT_EQ(found.poses.state, expected.poses.state);
    EXPECT_EQ(found.item, expected.item);
    EXPECT_EQ(found.inputs, expected.inputs);
    EXPECT_EQ(found.measured, expected.measured);
    EXPECT_EQ(found.uncertainty, expected.uncertainty);
    EXPECT_EQ(found.covariance, expected.covariance);
    EXPECT_EQ(found.time_s, expected.time_s);
    EXPECT_EQ(found.point_name, expected.point_name);
  }
  EXPECT_TRUE(left.empty());
}

TEST(ReadingsBytes, ThatAreCutOffAreRefused) {
  InstrumentReadings readings = readings_of({1, 2}, {3, 4}, {0, 1});
  readings.point_name = {"one", "two"};
  std::vector<std::byte> bytes;
  pack_readings(readings, bytes);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    std::span<const std::byte> left = std::span(bytes).first(size);
    EXPECT_THROW(unpack_readings(left), WorkError) << size;
  }
}

}  // namespace
}  // namespace abbe
