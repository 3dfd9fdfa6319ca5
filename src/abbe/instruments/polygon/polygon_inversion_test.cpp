#include "abbe/instruments/polygon/polygon_inversion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "abbe/geometry/angle_units.h"
#include "abbe/instruments/polygon/polygon_for_test.h"

namespace abbe {
namespace {

constexpr double kMicrometre = 1e-3;

TEST(PolygonInversion, RayTracedReadingsGiveTheirMotionsBack) {
  for (const PolygonFaceOrder order : {PolygonFaceOrder::face, PolygonFaceOrder::paper}) {
    for (const PolygonInversionOrder steps : {PolygonInversionOrder::stepwise, PolygonInversionOrder::simultaneous}) {
      const test::PolygonCase c = test::random_polygon(12, 100 * kArcsec, 0.1, 31, order);
      RandomStream random(4);
      double angle = 0, length = 0;
      for (std::size_t step = 0; step < 24; ++step) {
        const PolygonPosition position = regular_position(12, step);
        const TableMotion truth = test::random_motion(random, 100 * kArcsec, 0.1);
        const PolygonInversion found =
            invert_polygon_readings(polygon_readings(c.polygon, c.mount, c.bench, position, truth), c.polygon, c.mount,
                                    c.bench, position, steps);
        ASSERT_EQ(found.status, PolygonInversionStatus::converged);
        angle = std::max(angle, (found.motion.angles - truth.angles).lpNorm<Eigen::Infinity>());
        length = std::max(length, (found.motion.displacement - truth.displacement).lpNorm<Eigen::Infinity>());
        EXPECT_NEAR(found.redundant_residual, 0, 1e-17);
      }
      EXPECT_LT(angle, 1e-11 * kArcsec);
      EXPECT_LT(length, 1e-10 * kMicrometre);
    }
  }
}

TEST(PolygonInversion, MotionsOfDegreesConvergeToo) {
  const test::PolygonCase c = test::random_polygon(12, 0.03, 1, 8);
  RandomStream random(9);
  const TableMotion truth = test::random_motion(random, 0.05, 2);
  const PolygonPosition position = regular_position(12, 7);
  const PolygonReadings readings = polygon_readings(c.polygon, c.mount, c.bench, position, truth);
  for (const PolygonInversionOrder steps : {PolygonInversionOrder::stepwise, PolygonInversionOrder::simultaneous}) {
    const PolygonInversion found = invert_polygon_readings(readings, c.polygon, c.mount, c.bench, position, steps);
    ASSERT_EQ(found.status, PolygonInversionStatus::converged);
    EXPECT_LT((found.motion.angles - truth.angles).norm(), 1e-14);
    EXPECT_LT((found.motion.displacement - truth.displacement).norm(), 1e-12);
  }
}

TEST(PolygonInversion, AWrongFaceShowsInTheReadingThatIsNotNeeded) {
  test::PolygonCase c = test::random_polygon(12, 10 * kArcsec, 0.01, 8);
  const PolygonPosition position = regular_position(12, 7);
  const PolygonReadings readings = polygon_readings(c.polygon, c.mount, c.bench, position, {});
  c.polygon.faces[position.face_y].azimuth_error += 3 * kArcsec;
  const PolygonInversion found = invert_polygon_readings(readings, c.polygon, c.mount, c.bench, position);
  ASSERT_EQ(found.status, PolygonInversionStatus::converged);
  EXPECT_NEAR(found.redundant_residual, -3 * kArcsec, 1e-8);
}

TEST(PolygonInversion, MissingReadingsAreNoAnswer) {
  const test::PolygonCase c = test::random_polygon(12, 10 * kArcsec, 0.01, 8);
  PolygonReadings readings = polygon_readings(c.polygon, c.mount, c.bench, regular_position(12, 0), {});
  readings[static_cast<std::size_t>(PolygonReading::autocollimator_y_about_z)] =
      std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(invert_polygon_readings(readings, c.polygon, c.mount, c.bench, regular_position(12, 0)).status,
            PolygonInversionStatus::converged);
  readings[static_cast<std::size_t>(PolygonReading::displacement_z)] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(invert_polygon_readings(readings, c.polygon, c.mount, c.bench, regular_position(12, 0)).status,
            PolygonInversionStatus::converged);
}

TEST(PolygonInversion, CorrectedFormulasLeaveOnlyTheSecondOrder) {
  // Halving all errors quarters what the corrected formulas leave; what is wrong in print is of first order.
  for (const PolygonFaceOrder order : {PolygonFaceOrder::face, PolygonFaceOrder::paper}) {
    double left[2][2] = {};
    for (const int halved : {0, 1}) {
      const double size = halved ? 0.5 : 1.0;
      test::PolygonCase c = test::random_polygon(12, 200 * kArcsec * size, 0.2 * size, 19, order);
      for (PolygonFace& face : c.polygon.faces) face.distance = 48.3;  // the formulas do not know r_j
      for (PolygonSensor* sensor : {&c.bench.displacement_x, &c.bench.displacement_y, &c.bench.displacement_z}) {
        sensor->exit.setZero();
      }
      c.bench.displacement_z.exit = {3, -2, 0};
      RandomStream random(6);
      const PolygonPosition start = regular_position(12, 0);
      const PolygonReadings at_start = polygon_readings(c.polygon, c.mount, c.bench, start, {});
      for (std::size_t step = 1; step < 12; ++step) {
        const PolygonPosition position = regular_position(12, step);
        const TableMotion truth = test::random_motion(random, 200 * kArcsec * size, 0.2 * size);
        const PolygonReadings now = polygon_readings(c.polygon, c.mount, c.bench, position, truth);
        for (const int corrected : {0, 1}) {
          const TableMotion found = first_order_motion(corrected ? PolygonFormula::corrected : PolygonFormula::printed,
                                                       now, at_start, c.polygon, c.mount, c.bench, position, start);
          left[corrected][halved] = std::max({left[corrected][halved], (found.angles - truth.angles).norm() / kArcsec,
                                              (found.displacement - truth.displacement).norm() / kMicrometre});
        }
      }
    }
    EXPECT_NEAR(left[1][0] / left[1][1], 4, 0.1);
    EXPECT_NEAR(left[0][0] / left[0][1], 2, 0.1);
    EXPECT_LT(left[1][0], 2);
    EXPECT_GT(left[0][0], 100);
  }
}

}  // namespace
}  // namespace abbe
