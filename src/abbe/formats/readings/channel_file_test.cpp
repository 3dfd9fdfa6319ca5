#include "abbe/formats/readings/channel_file.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/readings/measurement_file.h"
#include "abbe/formats/text/message_of.h"

namespace abbe {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

Machine warm_slide() {
  return parse_machine(R"(name = "slide"
chain = "w b X t"
[axis.X]
travel_mm = [0, 100]
[state.air]
kind = "measured"
unit = "degC"
[state.feed]
kind = "measured"
unit = "1"
[state.column]
kind = "lag"
of = "air"
time_constant_s = 600
)",
                       "slide.machine.toml");
}

constexpr std::size_t kAir = 0, kFeed = 1, kColumn = 2;

StateChannels channels_of(const std::string& text, const ChannelFile& description = {}) {
  StateChannels channels;
  channels.add(text, "log.csv", warm_slide(), description);
  return channels;
}

std::string message_of_channels(const std::string& text, const ChannelFile& description = {}) {
  return message_of([&] { channels_of(text, description); });
}

TrackerReadings readings_of(const std::string& text, const StateChannels& channels,
                            std::vector<UncertainStart>* starts = nullptr) {
  MeasurementOptions options;
  options.channels = {&channels, starts};
  return parse_measurements(text, "r.csv", warm_slide(), options).readings;
}

std::string message_of_readings(const std::string& text, const StateChannels& channels) {
  return message_of([&] { readings_of(text, channels); });
}

const char* const kThree =
    "# three readings\nX_mm,measured_x_mm,measured_y_mm,measured_z_mm,time_min\n1,1,0,0,1\n2,2,0,0,0\n\n3,3,0,0,2\n";

TEST(ChannelFile, GivesReadingsTheValuesAtTheirTimesInAnyOrder) {
  StateChannels channels = channels_of("time_s,air_degC\n0,20\n120,26\n");
  // Another file has other times and another unit of them.
  channels.add("time_h,feed\n-1,0\n1,0.5\n", "feed.csv", warm_slide(), {});
  const TrackerReadings readings = readings_of(kThree, channels);
  EXPECT_THAT(readings.time_s, ElementsAre(60, 0, 120));
  EXPECT_THAT(readings.poses.state[kAir], ElementsAre(23, 20, 26)) << "also at the ends of the channel";
  EXPECT_NEAR(readings.poses.state[kFeed][0], 0.25 + 0.25 / 60, 1e-15);
  const double x = 0.1;  // 60 s of 600 s
  EXPECT_NEAR(readings.poses.state[kColumn][0], 23 - 3 * (1 - std::exp(-x)) / x, 1e-12);
  EXPECT_EQ(readings.poses.state[kColumn][1], 20);
}

TEST(ChannelFile, ExtrapolatesNothingAndNamesTheReading) {
  const StateChannels channels = channels_of("time_s,air_degC\n0,20\n119,26\n");
  EXPECT_EQ(message_of_readings(kThree, channels),
            "r.csv:6: time_min: air is not known at 120 s: log.csv covers 0 s to 119 s; expected a channel that covers "
            "all readings; nothing is extrapolated");
  EXPECT_THAT(message_of_readings(kThree, channels_of("time_s,air_degC\n30,20\n")),
              HasSubstr("r.csv:3: time_min: air is not known at 60 s: log.csv covers 30 s to 30 s"));
  EXPECT_THAT(message_of_readings(kThree, channels_of("time_s,air_degC\n0,\n200,\n")),
              HasSubstr("air is not known: log.csv has no value of it; expected values of it"));
}

TEST(ChannelFile, MissingValuesAreNotBridgedUnlessTheFileMayHaveGaps) {
  const std::string text = "time_s,air_degC,feed\n0,20,1\n50,,1\n100,22,1\n200,22,1\n";
  EXPECT_EQ(message_of_readings(kThree, channels_of(text)),
            "r.csv:3: time_min: air is not known at 60 s, in a gap of log.csv from 0 s to 100 s; expected "
            "largest_gap_s of at least 100 for this file if a straight line across the gap is acceptable");
  ChannelFile bridged;
  bridged.largest_gap_s = 100;
  EXPECT_NEAR(readings_of(kThree, channels_of(text, bridged)).poses.state[kAir][0], 21.2, 1e-14);
  // The lag remembers the gap although the reading is behind it.
  const std::string late = "X_mm,measured_x_mm,measured_y_mm,measured_z_mm,time_s\n1,1,0,0,150\n";
  EXPECT_THAT(message_of_readings(late, channels_of(text)),
              HasSubstr("r.csv:2: time_s: column is not known at 150 s, too soon after a gap of log.csv from 0 s to "
                        "100 s; expected readings 1800 s behind the gap (3 time constants), or largest_gap_s"));
}

TEST(ChannelFile, AStateIsGivenInOnePlaceOnly) {
  const StateChannels channels = channels_of("time_s,air_degC\n0,20\n120,26\n");
  EXPECT_EQ(
      message_of_readings("X_mm,measured_x_mm,measured_y_mm,measured_z_mm,time_s,air_degC\n1,1,0,0,1,20\n", channels),
      "r.csv: air_degC: is given here and in log.csv; expected only one of them");
  EXPECT_EQ(message_of([&] {
              StateChannels twice = channels;
              twice.add("time_s,air_degC\n0,20\n", "other.csv", warm_slide(), {});
            }),
            "other.csv: air_degC: log.csv has a column of it too; expected one file for each state");
  EXPECT_EQ(
      message_of_readings("X_mm,measured_x_mm,measured_y_mm,measured_z_mm\n1,1,0,0\n", channels),
      "r.csv: time: missing column; expected time_s, time_min or time_h, at which air is to be taken from log.csv");
  // A column of the lag itself counts, in the readings or in a channel.
  const TrackerReadings own =
      readings_of("X_mm,measured_x_mm,measured_y_mm,measured_z_mm,time_s,column_degC\n1,1,0,0,60,30\n", channels);
  EXPECT_THAT(own.poses.state[kColumn], ElementsAre(30));
  EXPECT_THAT(own.poses.state[kAir], ElementsAre(23));
  const StateChannels both = channels_of("time_s,air_degC,column_degC\n0,20,19\n120,26,21\n");
  EXPECT_THAT(readings_of(kThree, both).poses.state[kColumn], ElementsAre(20, 19, 21));
}

TEST(ChannelFile, TimesIncrease) {
  EXPECT_EQ(message_of_channels("time_s,air_degC\n0,20\n# noon\n5,21\n5,22\n"),
            "log.csv:5: time_s: 5 s occurs twice; expected times that increase; they must not restart at midnight");
  EXPECT_THAT(message_of_channels("time_s,air_degC\n0,20\n5,21\n4,22\n"),
              HasSubstr("log.csv:4: time_s: 4 s follows 5 s"));
}

TEST(ChannelFile, WhatIsWrongWithItsColumnsIsSaid) {
  EXPECT_THAT(message_of_channels("air_degC\n20\n"), HasSubstr("time"));
  EXPECT_EQ(message_of_channels("time_s\n0\n"),
            "log.csv: has no column of a state; expected air_degC, feed, column_degC");
  EXPECT_THAT(message_of_channels("time_s,air_degC,spare_degC\n0,20,20\n"), HasSubstr("spare_degC: unknown column"));
  EXPECT_THAT(message_of_channels("time_s,air_degC\n0,nan\n"), HasSubstr("log.csv:2"));
  ChannelFile logger;
  logger.mapping.columns = {{"time_min", "t"}, {"air_degC", "T 1"}};
  logger.mapping.ignore = {"T 2"};
  EXPECT_EQ(channels_of("t,T 1,T 2\n1,20,x\n", logger).of(kAir)->time_s.front(), 60);
}

TEST(ChannelFile, ALagStartsInEquilibriumUnlessItsStartIsGiven) {
  StateChannels channels = channels_of("time_s,air_degC\n-300,20\n120,20\n");
  std::vector<UncertainStart> starts;
  EXPECT_THAT(readings_of(kThree, channels, &starts).poses.state[kColumn], ElementsAre(20, 20, 20));
  ASSERT_THAT(starts, SizeIs(1));
  EXPECT_EQ(starts[0].state, kColumn);
  EXPECT_EQ(uncertain_start_words(warm_slide(), starts[0]),
            "column is taken to be in equilibrium with air at -300 s, where log.csv begins; the first reading is 300 s "
            "later, at which 61 % of a wrong start remain (time constant 600 s); expected a record that begins 1800 s "
            "before the readings, or lag_start.column_degC");
  channels.start_lags(warm_slide(), {{kColumn, 18}});
  starts.clear();
  EXPECT_NEAR(readings_of(kThree, channels, &starts).poses.state[kColumn][1], 20 - 2 * std::exp(-0.5), 1e-12);
  EXPECT_THAT(starts, IsEmpty());
  readings_of(kThree, channels_of("time_s,air_degC\n-1800,20\n120,20\n"), &starts);
  EXPECT_THAT(starts, IsEmpty()) << "three time constants are enough";

  EXPECT_EQ(message_of([&] {
              channels.start_lags(warm_slide(), {{kAir, 18}});
            }),
            "lag_start.air_degC: is not computed from a channel; expected a state of kind \"lag\"");
  EXPECT_EQ(message_of([&] {
              StateChannels other = channels_of("time_s,feed\n0,1\n");
              other.start_lags(warm_slide(), {{kColumn, 18}});
            }),
            "lag_start.column_degC: is not computed from a channel; expected a file with a column air_degC and none of "
            "column_degC");
}

TEST(ChannelFile, HundredThousandReadingsMeetAHundredThousandSamples) {
  std::string log = "time_s,air_degC\n", text = "X_mm,measured_x_mm,measured_y_mm,measured_z_mm,time_s\n";
  const int count = 100000;
  for (int k = 0; k < count; ++k) {
    log += fmt::format("{},{:.4f}\n", k, 20 + 3 * std::sin(1e-4 * k));
    text += fmt::format("{},1,0,0,{:.3f}\n", k % 100, 0.999 * k);
  }
  const TrackerReadings readings = readings_of(text, channels_of(log));
  ASSERT_THAT(readings.poses.state[kColumn], SizeIs(count));
  for (int k = 0; k < count; k += 101) {
    EXPECT_NEAR(readings.poses.state[kAir][static_cast<std::size_t>(k)], 20 + 3 * std::sin(0.999e-4 * k), 1e-4);
  }
}

}  // namespace
}  // namespace abbe
