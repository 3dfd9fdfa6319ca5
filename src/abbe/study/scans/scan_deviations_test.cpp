#include "abbe/study/scans/scan_deviations.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "abbe/formats/text/message_of.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/report/evaluations/evaluation_report.h"

namespace abbe {
namespace {

using testing::HasSubstr;

ScanDeviationsRequest bracket_deviations() {
  const std::string examples = ABBE_SOURCE_DIR "/examples/scan/";
  ScanDeviationsRequest request;
  request.scan_file = "scans/bracket-scan.csv";
  request.part_file = "bracket.stl";
  request.transform_file = "bracket-transform.csv";
  request.scan = read_point_cloud(examples + "bracket-scan.csv");
  request.part = read_mesh(examples + "bracket.stl");
  request.pose = read_transform_file(examples + "bracket-transform.csv");
  request.largest_mm = 0.3;
  return request;
}

TEST(ScanDeviationsOfARequest, AreThoseOfTheScanWhereItLies) {
  const ScanDeviations result = [] { return find_deviations(bracket_deviations()); }();
  ASSERT_TRUE(result.has_points());
  EXPECT_EQ(result.report.title, "Deviation of bracket-scan.csv from bracket.stl");
  EXPECT_TRUE(std::all_of(result.compared.counted_mm.begin(), result.compared.counted_mm.end(),
                          [](double d) { return std::abs(d) <= 0.3; }));
  EXPECT_FALSE(result.report.page.is_object());
  const auto files = deviation_files(result);
  ASSERT_EQ(files.size(), 2U);
  const PointCloudFile read = parse_point_cloud(files[0].second, files[0].first);
  EXPECT_EQ(read.deviation_mm, result.compared.counted_mm);
  EXPECT_EQ(files[1].first, "deviation.ply");
  // As it stands the scan is elsewhere.
  ScanDeviationsRequest request = bracket_deviations();
  request.pose = {};
  request.scan.cloud.points.colwise() += Eigen::Vector3d(0, 0, 1000);
  const ScanDeviations elsewhere = find_deviations(request);
  EXPECT_FALSE(elsewhere.has_points());
}

TEST(ScanDeviationsOfARequest, SayThatTheScanIsElsewhere) {
  ScanDeviationsRequest request = bracket_deviations();
  request.largest_mm = 0;
  EXPECT_FALSE(find_deviations(request).elsewhere);
  for (const double shift_mm : {-300.0, 300.0}) {
    request = bracket_deviations();
    request.largest_mm = 0;
    request.scan.cloud.points.colwise() += Eigen::Vector3d(0, 0, shift_mm);
    const ScanDeviations elsewhere = find_deviations(request);
    EXPECT_TRUE(elsewhere.has_points());
    EXPECT_TRUE(elsewhere.elsewhere);
    ASSERT_FALSE(elsewhere.report.notes.empty());
    EXPECT_THAT(elsewhere.report.notes.front(), HasSubstr("The scan is not where the part is: half of its points"));
  }
}

TEST(ScanDeviationsOfARequest, HaveFacesAndAPageWhereTheyAreAskedFor) {
  ScanDeviationsRequest request = bracket_deviations();
  EXPECT_EQ(find_deviations(request).compared.faces.count(), 0U);
  request.faces = DeviationFaces::by_edges;
  request.crease = 30 * kDegree;
  request.page = true;
  request.colour_mm = 0.05;
  const ScanDeviations result = find_deviations(request);
  EXPECT_GT(result.compared.faces.count(), 3U);
  EXPECT_TRUE(result.report.page.is_object());
  EXPECT_EQ(result.colour_mm, 0.05);
}

TEST(ScanDeviationsOfARequest, AreJudgedByTheTolerancesOfTheRequest) {
  ScanDeviationsRequest request = bracket_deviations();
  EXPECT_FALSE(find_deviations(request).report.exceeds_tolerance());
  request.tolerances = {"maximum_um=1"};
  EXPECT_TRUE(find_deviations(request).report.exceeds_tolerance());
  request.tolerances = {"maximum_um=400"};
  EXPECT_FALSE(find_deviations(request).report.exceeds_tolerance());
}

TEST(ScanDeviationsOfARequest, StopWhenAsked) {
  std::stop_source source;
  source.request_stop();
  EXPECT_THROW(find_deviations(bracket_deviations(), {.stop = source.get_token()}), Stopped);
}

TEST(ScanDeviationsOfARequest, WhatCannotBeComparedIsSaid) {
  const auto problem = [](const auto& change) {
    ScanDeviationsRequest request = bracket_deviations();
    change(request);
    return message_of([&] { find_deviations(request); });
  };
  using Request = ScanDeviationsRequest;
  EXPECT_THAT(problem([](Request& r) { r.pose.status = "no_start"; }),
              HasSubstr("status: the registration that wrote this transform says no_start"));
  ScanDeviationsRequest one_of_many = bracket_deviations();
  one_of_many.pose.status = "ambiguous";
  EXPECT_NO_THROW(find_deviations(one_of_many));
  EXPECT_THAT(problem([](Request& r) {
                r.tolerance = DeviationTolerance{0.1, -0.1};
              }),
              HasSubstr("--lower-um: lies above --upper-um"));
  EXPECT_THAT(problem([](Request& r) { r.faces = DeviationFaces::of_file; }),
              HasSubstr("bracket.stl: the file states no faces"));
  EXPECT_THAT(problem([](Request& r) { r.scan.cloud = {}; }), HasSubstr("bracket-scan.csv: there is no point"));
  EXPECT_THAT(problem([](Request& r) { r.part.mesh = {}; }), HasSubstr("bracket.stl: there is no triangle"));
}

}  // namespace
}  // namespace abbe
