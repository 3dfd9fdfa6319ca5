#include "abbe/study/scans/scanned_points.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <stop_token>
#include <string>

#include "abbe/formats/files/empty_folder_for_test.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/shapes/point_cloud_file.h"
#include "abbe/formats/text/message_of.h"
#include "abbe/geometry/stopped.h"

namespace abbe {
namespace {

using testing::HasSubstr;

/// Readings in a folder of their own.
class PointsOfAProbe : public testing::Test {
 protected:
  void SetUp() override {
    // Tests run side by side.
    const std::string name = testing::UnitTest::GetInstance()->current_test_info()->name();
    folder = test::empty_folder(("abbe_scanned_points_" + name).c_str());
    request.machine = read_machine(ABBE_SOURCE_DIR "/examples/machines/liu-scanner.machine.toml");
    request.readings = (folder / "r.csv").string();
    request.output = (folder / "p.csv").string();
    write_readings("0,0,0,0,0,0\n0,0,5,0,0,0.5\n0,0,15,0,0,0\n");
  }
  void write_readings(const std::string& rows) const {
    std::ofstream(request.readings) << "C_deg,A_deg,X_mm,Y_mm,Z_mm,indication_mm\n" << rows;
  }
  /// Errors that are known for X from -10 to 10 mm.
  void take_errors_of_a_part_of_the_travel() {
    request.errors_file = "e.errors.toml";
    request.errors = parse_errors(
                         "[[motion]]\nname = \"EXX\"\nbasis = \"monomial\"\norder = 1\nfrom_mm = -10\nto_mm = 10\n"
                         "coefficients_um = [0, 1]\n",
                         request.errors_file, request.machine)
                         .errors;
  }
  Eigen::Matrix3Xd points() const { return read_point_cloud(request.output).cloud.points; }
  std::string problem() const {
    return message_of([&] { write_scanned_points(request); });
  }

  std::filesystem::path folder;
  ScannedPointsRequest request;
};

TEST_F(PointsOfAProbe, AreWhereTheBeamEnds) {
  const ScannedPoints along_tool = write_scanned_points(request);
  EXPECT_EQ(along_tool.refused, "");
  EXPECT_EQ(along_tool.summary.points, 3U);
  const Eigen::Matrix3Xd first = points();
  // The second indication moves the point by half a millimetre along the beam.
  EXPECT_NEAR((first.col(1) - (first.col(0) + (first.col(2) - first.col(0)) / 3)).norm(), 0.5, 1e-8);
  EXPECT_THAT(scanned_points_text(along_tool), testing::StartsWith("3 readings on " + request.machine.name +
                                                                   ", machine without errors\n3 points written"));
  // A beam of any length, from another zero.
  request.beam = Eigen::Vector3d(-3 * request.machine.tool_direction);
  request.beam_zero = {0, 0, 1};
  write_scanned_points(request);
  const Eigen::Matrix3Xd shifted = points();
  for (Eigen::Index i = 0; i < 3; ++i) EXPECT_NEAR((shifted.col(i) - first.col(i)).norm(), 1, 1e-8);
  EXPECT_NEAR((shifted.col(1) - first.col(1) - (shifted.col(0) - first.col(0))).norm(), 0, 1e-8);
}

TEST_F(PointsOfAProbe, IndicationsOutsideTheRangeAreLeftOut) {
  request.indication_range = {-0.1, 0.1};
  const ScannedPoints two = write_scanned_points(request);
  EXPECT_EQ(two.summary.points, 2U);
  EXPECT_EQ(two.left_out().count(), 0U);
  EXPECT_EQ(two.refused, "");
  EXPECT_EQ(scanned_points_json(two)["outside_indication_range"], 1);
  EXPECT_THAT(scanned_points_text(two), HasSubstr("  1 readings outside the probe's range are left out\n"));
  request.indication_range = {1, 2};
  const ScannedPoints none = write_scanned_points(request);
  EXPECT_EQ(none.refused, "no reading lies within the probe's range");
  EXPECT_FALSE(scanned_points_json(none).contains("lowest_mm"));
}

TEST_F(PointsOfAProbe, ReadingsWhereTheErrorsAreNotKnownAreLeftOut) {
  take_errors_of_a_part_of_the_travel();
  const ScannedPoints two = write_scanned_points(request);
  EXPECT_EQ(two.summary.points, 2U);
  EXPECT_EQ(two.left_out().count(), 1U);
  EXPECT_EQ(two.refused, "");
  EXPECT_THAT(scanned_points_text(two), HasSubstr("errors of e.errors.toml"));
  write_readings("0,0,15,0,0,0\n");
  EXPECT_THAT(write_scanned_points(request).refused, testing::StartsWith("1 of 1 readings lies outside the range"));
}

TEST_F(PointsOfAProbe, WhatIsWrongIsNamedAndNothingIsWritten) {
  for (const Eigen::Vector3d& direction :
       {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(std::numeric_limits<double>::infinity(), 0, 0),
        Eigen::Vector3d(std::numeric_limits<double>::quiet_NaN(), 0, 0)}) {
    request.beam = direction;
    EXPECT_EQ(problem(), "--beam: the direction has no length; expected three numbers, not all of them zero");
  }
  request.beam.reset();
  request.beam_zero = {std::numeric_limits<double>::infinity(), 0, 0};
  EXPECT_EQ(problem(), "--beam-zero-mm: not a place; expected three finite numbers in mm");
  request.beam_zero.setZero();
  for (const double highest : {1.0, 0.0, std::numeric_limits<double>::quiet_NaN()}) {
    request.indication_range = {1, highest};
    EXPECT_EQ(problem(), "--indication-range-mm: the range is empty; expected the lower end first");
  }
  request.indication_range.reset();
  write_readings("0,0,500,0,0,0\n");
  EXPECT_THAT(problem(), HasSubstr("r.csv:2:1: X_mm: 500 mm is outside the travel of axis X"));
  EXPECT_FALSE(std::filesystem::exists(request.output));
  request.output += ".xyz";
  EXPECT_THAT(problem(), HasSubstr("unknown kind of file for points"));
}

TEST_F(PointsOfAProbe, ProgressComesToItsEndAndAStopOnTheWayLeavesNoOutput) {
  std::string rows;
  for (int i = 0; i < 200'000; ++i) rows += "0,0,0,0,0,0\n";
  write_readings(rows);
  request.scan.threads = 1;  // less than all readings are passed at a time
  std::size_t last = 0, all = 0;
  write_scanned_points(request, {.progress = [&](std::size_t done, std::size_t total) {
                         last = done;
                         all = total;
                       }});
  EXPECT_GT(all, rows.size());
  EXPECT_EQ(last, all);
  std::filesystem::remove(request.output);
  std::stop_source stop;
  std::size_t told = 0;
  const JobOptions options{.progress =
                               [&](std::size_t done, std::size_t) {
                                 told = done;
                                 stop.request_stop();
                               },
                           .stop = stop.get_token()};
  EXPECT_THROW(write_scanned_points(request, options), Stopped);
  EXPECT_GT(told, 0U);
  EXPECT_LT(told, all);
  EXPECT_FALSE(std::filesystem::exists(request.output));
}

}  // namespace
}  // namespace abbe
