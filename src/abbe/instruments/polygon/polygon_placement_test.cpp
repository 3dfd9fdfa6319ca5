#include "abbe/instruments/polygon/polygon_placement.h"

#include <gtest/gtest.h>

#include <numbers>

#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

PolygonPlacement on(const Machine& machine, const char* axis) {
  PolygonPlacement placement;
  placement.axis = machine.find_axis(axis);
  placement.aligned_at.assign(machine.axes.size(), 0.0);
  return placement;
}

PolygonGaugeSetup twelve_faces() {
  PolygonGaugeSetup setup;
  setup.polygon = regular_polygon(12, 48.3, 17);
  return setup;
}

/// Prism in the bench, nominally.
RigidTransform bench_from_prism(const Machine& machine, const PolygonGaugeSetup& setup,
                                const std::vector<double>& positions) {
  return setup.sensors_from_bench.inverse() * nominal_seen(machine, positions, setup.table_body, setup.sensor_body) *
         setup.table_from_prism;
}

TEST(PolygonPlacement, ThePrismStandsStraightInItsBenchWhereItIsAligned) {
  // Table in a cradle, aligned with the table turned; a prism in the fork head's own rotary axis, seen from the table.
  const Machine mill = test::trunnion_mill();
  PolygonPlacement placement = on(mill, "C");
  placement.centre = {0, 0, 40};
  placement.toward_x = {1, 1, 0};
  placement.aligned_at[mill.find_axis("C")] = 0.7;
  PolygonGaugeSetup setup = twelve_faces();
  place_polygon(mill, placement, setup);
  RigidTransform seen = bench_from_prism(mill, setup, placement.aligned_at);
  EXPECT_TRUE(seen.rotation.isApprox(Eigen::Matrix3d::Identity(), 1e-14));
  EXPECT_LT(seen.translation.norm(), 1e-12);
  EXPECT_TRUE(setup.sensors_from_bench.rotation.col(0).isApprox(Eigen::Vector3d(1, 1, 0).normalized(), 1e-14));
  // A positive command of C' turns the table, seen from the bed, the other way: by -30 deg about the prism's axis.
  std::vector<double> positions = placement.aligned_at;
  positions[mill.find_axis("C")] += std::numbers::pi / 6;
  seen = bench_from_prism(mill, setup, positions);
  EXPECT_NEAR(std::atan2(seen.rotation(1, 0), seen.rotation(0, 0)), -std::numbers::pi / 6, 1e-14);
  EXPECT_NEAR(seen.rotation(2, 2), 1, 1e-14);
  EXPECT_LT(seen.translation.norm(), 1e-12);
}

TEST(PolygonPlacement, ThePrismMayHangInTheSpindle) {
  // The fork head's C turns the tool; its prism hangs head down and is seen from the workpiece table.
  const Machine machine = test::swivel_head_mill();
  PolygonPlacement placement = on(machine, "B");
  placement.table_body = Body::tool;
  placement.sensor_body = Body::bed;
  // The point of the tool through which the axis of B passes, as the tool sees it.
  const RigidTransform tool = nominal_seen(machine, placement.aligned_at, Body::tool, Body::bed);
  placement.centre = tool.inverse() * machine.axes[machine.find_axis("B")].point;
  placement.top = {0, -1, 0};
  PolygonGaugeSetup setup = twelve_faces();
  place_polygon(machine, placement, setup);
  EXPECT_TRUE(setup.sensors_from_bench.rotation.col(2).isApprox(Eigen::Vector3d(0, -1, 0), 1e-14));
  EXPECT_NEAR(setup.sensors_from_bench.rotation.determinant(), 1, 1e-14);
  std::vector<double> positions = placement.aligned_at;
  positions[placement.axis] = 0.4;
  const RigidTransform seen = bench_from_prism(machine, setup, positions);
  EXPECT_LT(seen.translation.norm(), 1e-9);
  EXPECT_NEAR(seen.rotation(2, 2), 1, 1e-14);
  EXPECT_NEAR(std::abs(std::atan2(seen.rotation(1, 0), seen.rotation(0, 0))), 0.4, 1e-13);
}

TEST(PolygonPlacement, WhatCannotBeMeasuredIsRefused) {
  const Machine mill = test::trunnion_mill();
  const auto refused = [&](const auto& change) {
    PolygonPlacement placement = on(mill, "C");
    change(placement);
    PolygonGaugeSetup setup = twelve_faces();
    EXPECT_THROW(place_polygon(mill, placement, setup), std::invalid_argument);
  };
  refused([&](PolygonPlacement& p) { p.axis = mill.find_axis("X"); });
  refused([](PolygonPlacement& p) { p.table_body = Body::tool; });  // C carries the table
  refused([](PolygonPlacement& p) { p.top = {0, 0.1, 1}; });
  refused([](PolygonPlacement& p) { p.toward_x = {1, 0, 0.1}; });
  refused([](PolygonPlacement& p) { p.centre = {13, 0, 0}; });
}

}  // namespace
}  // namespace abbe
