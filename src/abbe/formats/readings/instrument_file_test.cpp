#include "abbe/formats/readings/instrument_file.h"

#include <numbers>

#include "abbe/formats/text/message_of.h"
#include "abbe/instruments/ball_bar.h"
#include "abbe/instruments/trackers/laser_tracker.h"
#include "abbe/machine/chain.h"

namespace abbe {
namespace {

Machine turntable() { return parse_chain("w C' X' b Z t").machine; }

BallBar bar(std::size_t balls) {
  BallBarSetup setup;
  setup.name = "bar";
  for (std::size_t i = 0; i < balls; ++i) setup.balls.push_back({"B" + std::to_string(i + 1), SetupPoint{}});
  return BallBar(setup);
}

TEST(InstrumentFile, ReadsBackWhatItWrote) {
  const Machine machine = turntable();
  const BallBar two = bar(2);
  InstrumentReadings readings;
  readings.append({0.5, -12.25, 3}, 1);
  readings.append({1e-9, 200, 1.0 / 3}, 0);
  readings.measured = {{100.00000123, 99.9}};
  readings.uncertainty = {{1e-4, 2e-4}};
  readings.time_s = {0, 1.5};
  const std::string text = instrument_readings_text(machine, two, readings);
  EXPECT_EQ(text.substr(0, text.find('\n')), "C_deg,X_mm,Z_mm,item,length_mm,u_length_um,time_s");
  const InstrumentReadings back = parse_instrument_readings(text, "r.csv", machine, two);
  EXPECT_EQ(back.item, readings.item);
  EXPECT_EQ(back.poses.axis[1], readings.poses.axis[1]);
  EXPECT_NEAR(back.poses.axis[0][0], 0.5, 1e-15);
  EXPECT_EQ(back.measured, readings.measured);
  EXPECT_EQ(back.uncertainty, readings.uncertainty);
  EXPECT_EQ(back.time_s, readings.time_s);
}

TEST(InstrumentFile, NeedsNoItemWhereThereIsOne) {
  const std::string text = "C_deg,X_mm,Z_mm,length_um\n90,1,2,100000\n";
  const InstrumentReadings readings = parse_instrument_readings(text, "r.csv", turntable(), bar(1));
  EXPECT_EQ(readings.item, std::vector<std::uint16_t>{0});
  EXPECT_DOUBLE_EQ(readings.measured[0][0], 100);
  EXPECT_DOUBLE_EQ(readings.poses.axis[0][0], std::numbers::pi / 2);
}

TEST(InstrumentFile, GivenRangesAreAboveZero) {
  const TrackerSetup setup{{TrackerStation{}}, {Reflector{}}};
  const auto polar = std::make_shared<const LaserTracker>("room", setup, TrackerMeasure::range_and_angles);
  const auto cartesian = std::make_shared<const LaserTracker>("room", setup, TrackerMeasure::cartesian);
  InstrumentReadings readings;
  for (int k = 0; k < 3; ++k) readings.append({0, 1, 2}, 0);
  readings.measured = {{1000, 1000, 1000}, {-1, 0, 1}, {0, -0.5, 0.5}};
  const auto message_with = [&](double range, const std::shared_ptr<const Instrument>& device) {
    readings.measured[0][1] = range;
    return message_of([&] { static_cast<void>(given_readings(readings, turntable(), device, "room", false)); });
  };
  EXPECT_EQ(message_with(-5, polar), "room: measured: reading 1: the range is -5 mm; expected a range above 0 mm");
  EXPECT_EQ(message_with(0, polar), "room: measured: reading 1: the range is 0 mm; expected a range above 0 mm");
  EXPECT_NO_THROW(static_cast<void>(given_readings(readings, turntable(), cartesian, "room", false)));
  readings.measured[0][1] = 1e-3;
  EXPECT_NO_THROW(static_cast<void>(given_readings(readings, turntable(), polar, "room", false)));
}

TEST(InstrumentFile, SaysWhatIsWrong) {
  const Machine machine = turntable();
  const BallBar one = bar(1), two = bar(2);
  const auto wrong = [&](const Instrument& instrument, const std::string& text) {
    return message_of([&] { parse_instrument_readings(text, "r.csv", machine, instrument); });
  };
  EXPECT_EQ(wrong(two, "C_deg,X_mm,Z_mm,length_mm\n0,1,2,100\n"),
            "r.csv: item: missing column; expected item, with one of B1, B2 in every row");
  EXPECT_EQ(wrong(two, "C_deg,X_mm,Z_mm,item,length_mm\n0,1,2,B1,100\n0,1,2,B3,100\n"),
            "r.csv:3: item: bar has no item 'B3'; expected one of B1, B2");
  EXPECT_NE(wrong(one, "C_deg,X_mm,Z_mm\n0,1,2\n").find("length_mm"), std::string::npos);
  EXPECT_NE(wrong(one, "C_deg,X_mm,Z_mm,length_deg\n0,1,2,3\n").find("length_deg"), std::string::npos);
  EXPECT_NE(wrong(one, "C_deg,X_mm,Z_mm,length_mm\n0,1e6,2,3\n").find("outside the travel of axis X"),
            std::string::npos);
  EXPECT_NE(wrong(one, "C_deg,X_mm,Z_mm,length_mm,u_length_um\n0,1,2,3,0\n").find("r.csv:2"), std::string::npos);
  EXPECT_NE(wrong(one, "C_deg,X_mm,Z_mm,length_mm\n0,1,2,nan\n").find("r.csv:2"), std::string::npos);
}

}  // namespace
}  // namespace abbe
