#include "abbe/study/compensation/found_positions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "abbe/formats/machine/placement_file.h"
#include "abbe/formats/text/message_of.h"

namespace abbe {
namespace {

using testing::HasSubstr;

PositionsRequest engraver_positions() {
  return read_positions_request(ABBE_SOURCE_DIR "/examples/laser_engraver/scanner.positioning.toml");
}

/// The bracket beside the scanner that sees it in the frame of its scan.
PositionsRequest bracket_positions() {
  const std::string examples = ABBE_SOURCE_DIR "/examples/scan/";
  PositionsRequest request = engraver_positions();
  request.file = "bracket.positioning.toml";
  request.scans.workpiece.emplace();
  request.scans.workpiece->part = "bracket.stl";
  request.scans.workpiece->scan = "bracket-scan.csv";
  request.part = read_mesh(examples + "bracket.stl");
  request.scan = read_point_cloud(examples + "bracket-scan.csv");
  return request;
}

TEST(FoundPositionsOfScans, AreThoseOfScannerAndWorkpiece) {
  const FoundPositions found = [] { return find_positions(engraver_positions()); }();
  ASSERT_TRUE(found.is_ok()) << found.problem;
  ASSERT_TRUE(found.workpiece);
  // Both positions meet in that of the workpiece on the table.
  const RigidTransform by_both = found.scanner.table_from_scanner * found.workpiece->fine.mesh_from_scan.inverse();
  EXPECT_LT((by_both.translation - found.workpiece->placement.table_from_workpiece.translation).norm(), 1e-9);
  EXPECT_EQ(found_positions_json(found)["status"], "ok");
  EXPECT_THAT(found_positions_text(found), HasSubstr("p_workpiece = D p_table (BCS to WCS)"));
  for (const bool to_workpiece : {true, false}) {
    const Placement read = parse_placement(found_placement_file(found, to_workpiece), "x").placement;
    EXPECT_LT((read.table_from_workpiece.translation - by_both.translation).norm(), 1e-6);
  }
}

TEST(FoundPositionsOfScans, AWorkpieceOnAMeshIsLaidOnIt) {
  PositionsRequest request = bracket_positions();
  request.part->left_out = {"#78 could not be converted"};
  request.scan->notes = {"2 points are left out: the file marks their coordinates as invalid"};
  std::size_t told = 0;
  const FoundPositions found = find_positions(request, {.progress = [&](std::size_t, std::size_t) { ++told; }});
  ASSERT_TRUE(found.is_ok()) << found.problem;
  EXPECT_GT(told, 0U);
  ASSERT_EQ(found.workpiece->warnings.size(), 2U);
  EXPECT_THAT(found.workpiece->warnings[0], testing::StartsWith("the part is incomplete: "));
  EXPECT_EQ(found.workpiece->warnings[1],
            "the scan: 2 points are left out: the file marks their coordinates as invalid");
  EXPECT_THAT(found_placement_file(found), HasSubstr("#78 could not be converted"));
  std::stop_source source;
  const auto stopping = [&](std::size_t, std::size_t) { source.request_stop(); };
  EXPECT_THROW(find_positions(request, {.progress = stopping, .stop = source.get_token()}), Stopped);
}

TEST(FoundPositionsOfScans, WithoutAWorkpieceOnlyTheScannerHasOne) {
  PositionsRequest request = engraver_positions();
  request.scans.workpiece.reset();
  const FoundPositions found = find_positions(request);
  EXPECT_TRUE(found.is_ok());
  EXPECT_FALSE(found.workpiece);
  EXPECT_FALSE(found_positions_json(found).contains("workpiece"));
}

TEST(FoundPositionsOfScans, WhatHasNoPositionIsSaid) {
  PositionsRequest request = engraver_positions();
  request.file = "scanner.positioning.toml";
  request.scans.scans.turned_positively = !request.scans.scans.turned_positively;
  const FoundPositions turned = find_positions(request);
  EXPECT_FALSE(turned.is_ok());
  EXPECT_THAT(turned.problem, testing::StartsWith("scanner.positioning.toml: the scanner's position is not found: "));
  EXPECT_FALSE(turned.workpiece);
  EXPECT_EQ(found_positions_json(turned)["status"], "no_position");
  request = engraver_positions();
  request.scans.workpiece->points.resize(3, 0);
  request.scans.workpiece->labels.clear();
  const FoundPositions unseen = find_positions(request);
  EXPECT_THAT(unseen.problem, HasSubstr("the workpiece's position is not found: "));
  ASSERT_TRUE(unseen.workpiece);
  EXPECT_FALSE(unseen.workpiece->ok);
  request = bracket_positions();
  request.scan.reset();
  EXPECT_THAT(message_of([&] { find_positions(request); }), HasSubstr("workpiece: its part or its scan is missing"));
}

}  // namespace
}  // namespace abbe
