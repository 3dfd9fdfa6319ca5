#include "abbe/plan/scans/scan_plan.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "abbe/geometry/surface/meshes_for_test.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

using std::numbers::pi;

ScanPlanOptions coarse() {
  ScanPlanOptions options;
  options.along = options.between = 1;
  options.probe_radius = 3;
  options.crease_angle = 20 * pi / 180;
  return options;
}

void expect_sound(const Machine& machine, const ScanPlan& plan, const ScanPlanOptions& options) {
  ASSERT_EQ(plan.positions.count(), plan.moves.size());
  double time = 0;
  std::vector<double> last;
  for (std::size_t k = 0; k < plan.moves.size(); ++k) {
    const PlannedMove& move = plan.moves[k];
    const std::vector<double> positions = plan.positions.pose(k);
    double least = move.measures ? 1 / options.readings_per_second : 0;
    for (std::size_t i = 0; i < positions.size(); ++i) {
      const Axis& axis = machine.axes[i];
      if (!axis.endless) {
        ASSERT_GE(positions[i], axis.travel_min - 1e-9);
        ASSERT_LE(positions[i], axis.travel_max + 1e-9);
      }
      const double speed = axis.kind == AxisKind::rotary ? options.rotary_speed : options.linear_speed;
      if (k > 0) least = std::max(least, std::abs(positions[i] - last[i]) / speed);
    }
    time += least;
    last = positions;
    if (!move.measures) continue;
    const RigidTransform pose = nominal_workpiece_from_tool(machine, positions);
    ASSERT_LT((pose.translation - move.point).norm(), 1e-6) << k;
    ASSERT_LT((pose.rotation * machine.tool_direction - move.beam).norm(), 1e-8) << k;
    ASSERT_GE(move.normal.dot(move.beam), std::cos(options.largest_angle) - 1e-12) << k;
  }
  EXPECT_NEAR(plan.time, time, 1e-6 * time);
}

TEST(ScanPlan, CoversAPrismByRastersAndACylinderByCircles) {
  const Machine machine = test::liu_scanner();
  const ScanPlanOptions options = coarse();
  const ScanPlan flat = plan_scan(machine, prism_for_test(5, 8, -6, 6), options);
  expect_sound(machine, flat, options);
  ASSERT_EQ(flat.faces.size(), 7U);
  for (const PlannedFace& face : flat.faces) EXPECT_EQ(face.kind, ScanPathKind::raster);
  EXPECT_GT(flat.covered_share(), 0.99);
  EXPECT_EQ(flat.blocked_links, 0U);
  EXPECT_EQ(flat.beyond_range, 0U);
  EXPECT_LT(flat.largest_sag, 1e-9);

  const ScanPlan round = plan_scan(machine, prism_for_test(90, 8, -6, 6), options);
  expect_sound(machine, round, options);
  ASSERT_EQ(round.faces.size(), 3U);
  std::size_t circles = 0;
  for (const PlannedFace& face : round.faces) circles += face.kind == ScanPathKind::rotary ? 1U : 0U;
  EXPECT_EQ(circles, 1U);
  EXPECT_GT(round.covered_share(), 0.99);
  // Half way along a step of 1 mm on a radius of 8 mm the axes turn too, so that the surface stays where it was, but
  // for the strips of the mesh.
  EXPECT_LT(round.largest_sag, 0.01);
  // The stage turns with the part: circles need C and nothing else.
  for (std::size_t k = 1; k < round.moves.size(); ++k) {
    if (!round.moves[k].measures || !round.moves[k - 1].measures) continue;
    if (round.faces[round.moves[k].face].kind != ScanPathKind::rotary) continue;
    ASSERT_NEAR(round.positions.axis[machine.find_axis("A")][k], 0, 1e-9);
  }
}

TEST(ScanPlan, WhatTheStageHidesIsNotPromised) {
  const Machine machine = test::liu_scanner();
  ScanPlanOptions options = coarse();
  options.stage = prism_for_test(60, 30, -20, -6.01);  // right below the part
  const ScanPlan plan = plan_scan(machine, prism_for_test(5, 8, -6, 6), options);
  expect_sound(machine, plan, options);
  std::size_t bottom = 0;
  const auto missed = [](const PlannedFace& face, ScanObstacle obstacle) {
    return face.missed[static_cast<std::size_t>(obstacle)];
  };
  for (const PlannedFace& face : plan.faces) {
    if (face.points > 0) continue;
    ++bottom;
    EXPECT_GT(missed(face, ScanObstacle::hidden), 20U);
    EXPECT_EQ(face.covered, 0);
    EXPECT_NEAR(face.uncovered[static_cast<std::size_t>(ScanObstacle::hidden)], face.area, 1e-9);
  }
  EXPECT_EQ(bottom, 1U);
  // A rod of 3 mm beside a stage of 30 mm: near the stage the sides are seen from above only, or not.
  std::size_t tilted = 0, collision = 0;
  for (const PlannedFace& face : plan.faces) {
    tilted += face.tilted;
    collision += missed(face, ScanObstacle::collision) + missed(face, ScanObstacle::working_distance);
  }
  EXPECT_GT(tilted + collision, 0U);
  EXPECT_LT(plan.covered_share(), 0.9);
  EXPECT_GT(plan.covered_share(), 0.5);
}

TEST(ScanPlan, StaysWithinTravel) {
  Machine machine = test::liu_scanner();
  const std::size_t a = machine.find_axis("A");
  machine.axes[a].endless = false;
  machine.axes[a].travel_min = -0.2;
  machine.axes[a].travel_max = 1.2;
  const ScanPlanOptions options = coarse();
  const ScanPlan plan = plan_scan(machine, prism_for_test(5, 8, -6, 6), options);
  expect_sound(machine, plan, options);
  std::size_t out_of_travel = 0;
  for (const PlannedFace& face : plan.faces)
    out_of_travel += face.missed[static_cast<std::size_t>(ScanObstacle::travel)];
  // The lower end would need A at -90 degrees; the upper one, at +90 degrees, is reached with a tilted beam.
  EXPECT_GT(out_of_travel, 20U);
  EXPECT_LT(plan.covered_share(), 0.95);
}

TEST(ScanPlan, MarksTheMovesOfWaysThatAreNotClear) {
  // The probe cannot draw back as far as the edges between the sides need when C turns the next side up.
  const ScanPlanOptions options = coarse();
  const TriangleMesh part = prism_for_test(5, 8, -6, 6);
  for (const double room : {0.4, 1.2}) {  // mm above the sides: for no way back at all, and for one of 1 mm
    Machine machine = test::liu_scanner();
    const ScanPlan free = plan_scan(machine, part, options);
    EXPECT_EQ(free.blocked_links, 0U);
    double highest = -1e9;
    const std::size_t z = machine.find_axis("Z");
    for (std::size_t k = 0; k < free.moves.size(); ++k) {
      EXPECT_FALSE(free.moves[k].blocked);
      // The ends, at 6 mm, are lower than the sides, at 6.47 mm.
      if (free.moves[k].measures) highest = std::max(highest, free.positions.axis[z][k]);
    }
    machine.axes[z].travel_max = highest + room;
    const ScanPlan plan = plan_scan(machine, part, options);
    expect_sound(machine, plan, options);
    EXPECT_EQ(plan.points(), free.points());
    EXPECT_GE(plan.blocked_links, 3U);  // between sides that follow each other
    std::size_t ways = 0, around = 0;
    for (std::size_t k = 1; k < plan.moves.size(); ++k) {
      const PlannedMove &move = plan.moves[k], &before = plan.moves[k - 1];
      if (!move.blocked) continue;
      ways += before.measures ? 1U : 0U;
      around += move.measures ? 0U : 1U;
      // Only at the beginning of a line, and to its end: all moves of the way.
      EXPECT_TRUE(before.blocked || (before.measures && (before.line != move.line || before.face != move.face)));
      EXPECT_TRUE(move.measures || plan.moves.at(k + 1).blocked);
    }
    EXPECT_EQ(ways, plan.blocked_links);
    EXPECT_EQ(around > 0, room > 1) << room;
  }
}

TEST(ScanPlan, GoesAroundWhereTheSurfaceWouldLeaveTheRangeBetweenPoints) {
  const Machine machine = test::liu_scanner();
  ScanPlanOptions options = coarse();
  const TriangleMesh part = prism_for_test(90, 8, -6, 6);
  const ScanPlan within = plan_scan(machine, part, options);
  EXPECT_EQ(within.beyond_range, 0U);
  // Flat strips of 4 degrees: up to 8 mm (1 - cos 2 deg) = 4.9 um off the circle.
  options.range = 2 * 0.25 * within.largest_sag;
  const ScanPlan plan = plan_scan(machine, part, options);
  expect_sound(machine, plan, options);
  EXPECT_GT(within.largest_sag, 5e-4);
  EXPECT_GT(plan.beyond_range, 10U);
  EXPECT_LE(plan.largest_sag, 0.5 * options.range);
  EXPECT_EQ(plan.points(), within.points());
  EXPECT_GT(plan.time, within.time);
  EXPECT_GE(plan.moves.size(), within.moves.size() + 2 * plan.beyond_range);
}

TEST(ScanPlan, RefusesAnglesOutOfTheirRangeAndNamesThemWithTheirUnit) {
  const Machine machine = test::liu_scanner();
  const auto refusal = [&](double ScanPlanOptions::*option, double degrees) -> std::string {
    ScanPlanOptions options = coarse();
    options.along = options.between = 4;
    options.*option = degrees * pi / 180;
    try {
      plan_scan(machine, prism_for_test(5, 8, -6, 6), options);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refusal(&ScanPlanOptions::largest_angle, 1.9),
            "largest angle of the scan: 1.9 degrees, not from 2 to 85 degrees");
  EXPECT_EQ(refusal(&ScanPlanOptions::crease_angle, 91),
            "crease angle of the scan: 91 degrees, not from 1 to 90 degrees");
  EXPECT_NE(refusal(&ScanPlanOptions::largest_angle, 86), "");
  EXPECT_NE(refusal(&ScanPlanOptions::largest_angle, std::nan("")), "");
  EXPECT_NE(refusal(&ScanPlanOptions::crease_angle, 0.5), "");
  for (const double degrees : {2.0, 85.0}) EXPECT_EQ(refusal(&ScanPlanOptions::largest_angle, degrees), "");
  for (const double degrees : {1.0, 90.0}) EXPECT_EQ(refusal(&ScanPlanOptions::crease_angle, degrees), "");
}

}  // namespace
}  // namespace abbe
