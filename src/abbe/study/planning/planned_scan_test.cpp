#include "abbe/study/planning/planned_scan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/shapes/mesh_file.h"
#include "abbe/formats/text/message_of.h"

namespace abbe {
namespace {

using testing::HasSubstr;

ScanRequest pyramid_to_scan() {
  const std::string examples = ABBE_SOURCE_DIR "/examples/";
  ScanRequest request;
  request.machine = read_machine(examples + "machines/liu-scanner.machine.toml");
  request.part_file = "parts/pyramid.stl";
  request.part = read_mesh(examples + "cradle_scanner/pyramid.stl").mesh;
  request.scan.along = request.scan.between = 5;
  return request;
}

TEST(PlannedScanOfAPart, CoversItAndNeedsTheRequestNoLonger) {
  std::size_t told = 0;
  const auto progress = [&told](std::size_t done, std::size_t total) {
    EXPECT_LE(done, total);
    ++told;
  };
  const PlannedScan planned = [&] { return plan_part_scan(pyramid_to_scan(), {.progress = progress}); }();
  EXPECT_EQ(told, planned.plan.faces.size());
  EXPECT_GT(planned.plan.points(), 10U);
  EXPECT_TRUE(planned.is_complete());
  EXPECT_THAT(planned_scan_text(planned), HasSubstr("pyramid.stl"));
  EXPECT_THAT(planned_scan_program(planned), HasSubstr("scan of pyramid.stl on " + planned.machine.name));
  EXPECT_THAT(planned_scan_csv(planned), testing::StartsWith("time_s,"));
  EXPECT_EQ(planned_scan_json(planned), planned_scan_json(plan_part_scan(pyramid_to_scan())));
  EXPECT_THAT(planned_scan_page(planned), HasSubstr("pyramid.stl"));
}

TEST(PlannedScanOfAPart, IsIncompleteWherePlacesAreNotReachedOrAWayIsNotClear) {
  ScanRequest request = pyramid_to_scan();
  PlannedScan planned = plan_part_scan(request);
  ASSERT_TRUE(planned.is_complete());
  planned.plan.blocked_links = 1;
  EXPECT_FALSE(planned.is_complete());
  // Faces that want the probe above this are out of reach, the others are not.
  request.machine.axes[request.machine.find_axis("Z")].travel_max = 5;
  planned = plan_part_scan(request);
  EXPECT_GT(planned.plan.points(), 0U);
  EXPECT_GT(planned.plan.missed_places(), 0U);
  EXPECT_EQ(planned.plan.blocked_links, 0U);
  EXPECT_FALSE(planned.is_complete());
}

TEST(PlannedScanOfAPart, IsStopped) {
  std::stop_source source;
  const auto progress = [&source](std::size_t, std::size_t) { source.request_stop(); };
  EXPECT_THROW(plan_part_scan(pyramid_to_scan(), {.progress = progress, .stop = source.get_token()}), Stopped);
}

TEST(PlannedScanOfAPart, WhatCannotBePlannedIsSaid) {
  const auto problem = [](const ScanRequest& request) { return message_of([&] { plan_part_scan(request); }); };
  ScanRequest request = pyramid_to_scan();
  request.scan.along = request.scan.between = 1e-3;
  EXPECT_THAT(problem(request), HasSubstr("--along-mm: "));
  request = pyramid_to_scan();
  request.scan.wanted = {{Eigen::Vector3d::UnitZ(), 1e6}};
  EXPECT_THAT(problem(request), HasSubstr("--beyond-plane-mm: nothing of the part lies there"));
  request = pyramid_to_scan();
  request.part.triangles.conservativeResize(3, request.part.triangles.cols() - 1);
  EXPECT_THAT(problem(request), HasSubstr("parts/pyramid.stl: "));
}

}  // namespace
}  // namespace abbe
