#include "abbe/study/planning/planned_measurement.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "abbe/formats/text/input_error.h"
#include "abbe/machine/chain.h"

namespace abbe {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

/// Four readings about the origin of a mill, of two stations that take turns.
MeasurementRequest mill_request() {
  MeasurementRequest request;
  request.machine = parse_chain("w X' Y' b Z t").machine;
  request.readings_file = "r.csv";
  request.list = parse_reading_list(
      "X_mm,Y_mm,Z_mm,station,target\n"
      "-100,0,10,a,m\n"
      "100,0,10,b,m\n"
      "100,0,10,a,n\n"
      "100,90,10,a,m\n",
      "r.csv", request.machine);
  request.program.dialect = NcDialect::linuxcnc;
  return request;
}

std::vector<std::size_t> numbers(const PlannedMeasurement& planned) {
  std::vector<std::size_t> all;
  for (const PlannedReading& reading : planned.readings) all.push_back(reading.number);
  return all;
}

std::string message_of_request(const MeasurementRequest& request) {
  try {
    plan_measurement(request);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(APlannedMeasurement, BringsTheReadingsOfAStationTogether) {
  MeasurementRequest request = mill_request();
  PlannedMeasurement planned = plan_measurement(request);
  EXPECT_THAT(numbers(planned), ElementsAre(1, 3, 4, 2));
  ASSERT_EQ(planned.sections.size(), 2U);
  EXPECT_EQ(planned.sections[1].words, "station b");
  EXPECT_EQ(planned.sections[1].first, 3U);
  EXPECT_THAT(planned.program, HasSubstr("(MSG, station a)\nM0\n(reading 1, station a, target m)\nG0 X-100.0"));
  request.sections = MeasurementSections::none;
  planned = plan_measurement(request);
  EXPECT_THAT(numbers(planned), ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(planned.program, Not(HasSubstr("M0\n")));
  EXPECT_EQ(measurement_sections("none"), MeasurementSections::none);
  EXPECT_FALSE(measurement_sections("readings"));
  // Readings 2 and 3 are at one pose: no block moves between them.
  EXPECT_THAT(planned.program, HasSubstr("(reading 3, station a, target n)\nG4 P2\n"));
}

TEST(APlannedMeasurement, AddsUpTheTime) {
  MeasurementRequest request = mill_request();
  request.sections = MeasurementSections::none;
  request.linear_speed = 50;
  request.program.dwell = 3;
  request.program.reading = 1;
  const PlannedMeasurement planned = plan_measurement(request);
  // 200 mm and 90 mm at 50 mm/s, and four times 4 s.
  EXPECT_NEAR(planned.time, 200 / 50.0 + 90 / 50.0 + 4 * 4, 1e-12);
  request.program.feed = 10;
  EXPECT_NEAR(plan_measurement(request).time, 200 / 10.0 + 90 / 10.0 + 4 * 4, 1e-12);
}

TEST(APlannedMeasurement, TakesTheShortWayOnRequest) {
  MeasurementRequest request = mill_request();
  std::string text = "X_mm,Y_mm,Z_mm\n";
  for (const int x : {0, 200, 20, 180, 40, 160, 60}) text += std::to_string(x) + ",0,0\n";
  request.list = parse_reading_list(text, "r.csv", request.machine);
  const double given = plan_measurement(request).time;
  request.shorten = true;
  const PlannedMeasurement shorter = plan_measurement(request);
  EXPECT_LT(shorter.time, given - 5);
  EXPECT_THAT(numbers(shorter), ElementsAre(1, 3, 5, 7, 6, 4, 2));
}

TEST(APlannedMeasurement, GoesAroundAnObstacleOrNamesBothReadingsAndIt) {
  MeasurementRequest request = mill_request();
  request.obstacles = {{"vice", box_mesh({-20, -20, -50}, {20, 20, 40}), ObstacleCarrier::table, 0}};
  request.tool = {5, 60};
  PlannedMeasurement planned = plan_measurement(request);
  EXPECT_THAT(planned.refused, HasSubstr("from reading 1 (line 2) to reading 3 (line 4) the tool touches vice at"));
  EXPECT_THAT(planned.refused, HasSubstr("neither --clearance-mm nor --clear-at is given"));
  EXPECT_TRUE(planned.program.empty());
  request.ways.clearance = 20;
  EXPECT_THAT(plan_measurement(request).refused, HasSubstr("no way with it retracted is clear either"));
  request.ways.clearance = 50;
  planned = plan_measurement(request);
  EXPECT_EQ(planned.refused, "");
  EXPECT_THAT(planned.program, HasSubstr("G0 Z60.000000\nG0 X100.000000\nG0 Z10.000000\n"));
  EXPECT_EQ(planned.ways_around(), 1U);
  EXPECT_THAT(planned.notes, testing::Contains(HasSubstr("the way to the first reading is not checked")));
  // From here the first reading cannot be reached but over the vice.
  request.start = {{0, 100}, {1, 0}, {2, 0}};
  planned = plan_measurement(request);
  EXPECT_EQ(planned.ways_around(), 2U);
  EXPECT_THAT(planned.notes, Not(testing::Contains(HasSubstr("is not checked"))));
}

TEST(APlannedMeasurement, RefusesReadingsWithinAnObstacle) {
  MeasurementRequest request = mill_request();
  request.obstacles = {{"vice", box_mesh({-120, -20, -50}, {-80, 20, 40}), ObstacleCarrier::table, 0}};
  request.ways.clearance = 200;
  EXPECT_THAT(plan_measurement(request).refused, HasSubstr("r.csv: at reading 1 (line 2) the tool touches vice"));
}

TEST(APlannedMeasurement, ChecksTheWayThatTheRoundedWordsMake) {
  MeasurementRequest request = mill_request();
  request.program.decimals = 1;
  request.list = parse_reading_list("X_mm,Y_mm,Z_mm\n0.04,0,0\n0.06,0,0\n", "r.csv", request.machine);
  const PlannedMeasurement planned = plan_measurement(request);
  EXPECT_NEAR(planned.readings[0].pose[0], 0, 1e-12);
  EXPECT_NEAR(planned.readings[1].pose[0], 0.1, 1e-12);
}

TEST(APlannedMeasurement, RefusesBadRequests) {
  MeasurementRequest request = mill_request();
  request.start = {{0, 0}};
  EXPECT_THAT(message_of_request(request), HasSubstr("--start: does not say where axis Y stands"));
  request.start = {{0, 251}};
  EXPECT_THAT(message_of_request(request),
              HasSubstr("251 mm is outside the travel of axis X; expected -250 to 250 mm"));
  request = mill_request();
  request.ways.clear_at = {{2, 1000}};
  EXPECT_THAT(message_of_request(request), HasSubstr("--clear-at: 1000 mm is outside"));
  request = mill_request();
  request.obstacles = {{"empty.stl", {}, ObstacleCarrier::base, 0}};
  EXPECT_THAT(message_of_request(request), HasSubstr("empty.stl: has no triangle"));
  request.obstacles = {{"box 1", box_mesh({0, 0, 0}, {1, 1, 1}), ObstacleCarrier::base, 0}};
  request.program.dialect = NcDialect::fanuc;
  EXPECT_THAT(message_of_request(request), HasSubstr("G0 of the dialect fanuc need not be a straight line"));
  request.list.readings.clear();
  EXPECT_THAT(message_of_request(request), HasSubstr("r.csv: has no reading"));
}

TEST(APlannedMeasurement, IsToldInWordsInJsonAndOnASheet) {
  MeasurementRequest request = mill_request();
  request.list.readings[1].what = "<b>";
  const PlannedMeasurement planned = plan_measurement(request);
  const std::string text = planned_measurement_text(planned);
  EXPECT_THAT(text, HasSubstr("4 readings of r.csv"));
  EXPECT_THAT(text, HasSubstr("3 at station a"));
  EXPECT_THAT(text, HasSubstr("X       -100.000 to      100.000 mm"));
  const nlohmann::ordered_json json = planned_measurement_json(planned);
  EXPECT_EQ(json.at("sections")[1].at("readings")[0].at("pose").at("X_mm"), 100);
  EXPECT_EQ(json.at("sections")[0].at("readings").size(), 3U);
  const std::string sheet = planned_measurement_sheet(planned);
  EXPECT_THAT(sheet, HasSubstr("Station a: 3 readings"));
  EXPECT_THAT(sheet, HasSubstr("&lt;b&gt;"));
  EXPECT_THAT(sheet, Not(HasSubstr("<b>")));
  EXPECT_THAT(sheet, HasSubstr("<td class=\"blank\"></td>"));
}

}  // namespace
}  // namespace abbe
