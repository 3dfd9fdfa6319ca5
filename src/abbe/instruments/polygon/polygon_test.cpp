#include "abbe/instruments/polygon/polygon.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "abbe/geometry/angle_units.h"
#include "abbe/instruments/polygon/polygon_for_test.h"
#include "abbe/instruments/polygon/polygon_trace.h"

namespace abbe {
namespace {

using test::random_motion;
using test::random_polygon;
using test::traced_ray;

TEST(Polygon, PerfectPrismReadsNothingButItsDistance) {
  const Polygon polygon = regular_polygon(12, 48.3, 17);
  const PolygonBench bench;
  for (std::size_t step = 0; step < 13; ++step) {
    for (const std::size_t shift : {0U, 1U, 5U}) {
      const double turn = 2 * std::numbers::pi * static_cast<double>(shift) / 12;
      const PolygonReadings r = polygon_readings(polygon, {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), turn},
                                                 bench, regular_position(12, step, shift), {});
      for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(r[i], 0, 2e-15);
      EXPECT_NEAR(r[4], 48.3 - 100, 1e-13);
      EXPECT_NEAR(r[5], 48.3 - 100, 1e-13);
      EXPECT_NEAR(r[6], 17 - 100, 1e-13);
    }
  }
}

TEST(Polygon, ReadingsEqualRaysTracedOneByOne) {
  for (const PolygonFaceOrder order : {PolygonFaceOrder::face, PolygonFaceOrder::paper}) {
    RandomStream random(7);
    const test::PolygonCase c = random_polygon(12, 0.02, 0.8, 3, order);
    for (std::size_t step = 0; step < 12; ++step) {
      const PolygonPosition position = regular_position(12, step);
      const TableMotion motion = random_motion(random, 0.02, 0.5);
      const PolygonReadings readings = polygon_readings(c.polygon, c.mount, c.bench, position, motion);
      for (std::size_t i = 0; i < kPolygonReadings; ++i) {
        const auto reading = static_cast<PolygonReading>(i);
        EXPECT_NEAR(readings[i], traced_ray(reading, c, position, motion), is_angle(reading) ? 1e-14 : 1e-12)
            << "reading " << i << " step " << step;
      }
    }
  }
}

TEST(Polygon, IndicationIsHalfTheTangentOfTwiceTheAngle) {
  const Polygon polygon = regular_polygon(12, 48.3, 17);
  const double omega = 300 * kArcsec;
  TableMotion motion;
  motion.angles.z() = omega;
  const PolygonReadings r = polygon_readings(polygon, {}, {}, regular_position(12, 0), motion);
  EXPECT_NEAR(r[0], std::tan(2 * omega) / 2, 1e-18);
  EXPECT_NEAR(r[3], std::tan(2 * omega) / 2, 1e-15);
  EXPECT_GT(r[0] - omega, 4e-9);  // a small-angle reading would be wrong by 0.0009 arcsec
}

TEST(Polygon, SmallErrorsEnterAsTheFirstOrderTheorySays) {
  // omega_x = eps_x + eps_xbc cos - eps_ybc sin + tilt, omega_y = eps_y + eps_xbc sin + eps_ybc cos - tilt,
  // omega_z = eps_z + azimuth error; both orders of the face.
  const double small = 1e-8;
  for (const bool paper : {false, true}) {
    RandomStream random(11);
    test::PolygonCase c;
    c.polygon = regular_polygon(12, 48.3, 17);
    c.polygon.order = paper ? PolygonFaceOrder::paper : PolygonFaceOrder::face;
    for (PolygonFace& face : c.polygon.faces) {
      face.azimuth_error = random.uniform(-small, small);
      face.tilt = random.uniform(-small, small);
    }
    c.mount.angles = test::random_vector(random, small);
    for (std::size_t step = 0; step < 12; ++step) {
      const TableMotion motion = random_motion(random, small, 0);
      const PolygonPosition position = regular_position(12, step);
      const double co = std::cos(position.angle), si = std::sin(position.angle);
      const PolygonFace &x = c.polygon.faces[position.face_x], &y = c.polygon.faces[position.face_y];
      const PolygonReadings r = polygon_readings(c.polygon, c.mount, c.bench, position, motion);
      const double turning = paper ? co : 1, ex = c.mount.angles.x(), ey = c.mount.angles.y();
      EXPECT_NEAR(r[0], motion.angles.z() + c.mount.angles.z() + x.azimuth_error, 3e-15);
      EXPECT_NEAR(r[1], motion.angles.y() + ex * si + ey * co - x.tilt * turning, 3e-15);
      EXPECT_NEAR(r[2], motion.angles.x() + ex * co - ey * si + y.tilt * turning, 3e-15);
    }
  }
}

TEST(Polygon, DistanceErrorOfAFaceEntersTheRadialReadingOneToOne) {
  Polygon polygon = regular_polygon(12, 48.3, 17);
  polygon.faces[4].distance += 0.003;
  const PolygonReadings r = polygon_readings(polygon, {}, {}, regular_position(12, 4), {});
  EXPECT_NEAR(r[4], -51.7 + 0.003, 1e-13);
  EXPECT_NEAR(r[5], -51.7, 1e-13);
  EXPECT_NEAR(polygon_readings(polygon, {}, {}, regular_position(12, 7), {})[5], -51.7 + 0.003, 1e-13);
}

TEST(Polygon, GradientsEqualCentralDifferences) {
  using namespace polygon_column;
  for (const PolygonFaceOrder order : {PolygonFaceOrder::face, PolygonFaceOrder::paper}) {
    const test::PolygonCase c = random_polygon(12, 0.05, 2, 17, order);
    RandomStream random(5);
    const TableMotion motion = random_motion(random, 0.05, 1);
    const PolygonPosition position = regular_position(12, 5, 1);
    PolygonMount mount = c.mount;
    mount.turn = 2 * std::numbers::pi / 12;
    for (std::size_t i = 0; i < kPolygonReadings; ++i) {
      const auto reading = static_cast<PolygonReading>(i);
      PolygonGradient gradient;
      polygon_reading(reading, c.polygon, mount, c.bench, position, motion, &gradient);
      for (int column = 0; column < count; ++column) {
        const auto moved = [&](double step) {
          test::PolygonCase m = c;
          PolygonMount moved_mount = mount;
          TableMotion moved_motion = motion;
          PolygonSensor& sensor = m.bench.sensor(reading);
          PolygonFace& face = m.polygon.faces[sensor.side == PolygonSide::y ? position.face_y : position.face_x];
          const bool top = sensor.side == PolygonSide::z;
          double* numbers[] = {&moved_motion.angles[0],
                               &moved_motion.angles[1],
                               &moved_motion.angles[2],
                               &moved_motion.displacement[0],
                               &moved_motion.displacement[1],
                               &moved_motion.displacement[2],
                               &moved_mount.angles[0],
                               &moved_mount.angles[1],
                               &moved_mount.angles[2],
                               &moved_mount.offset[0],
                               &moved_mount.offset[1],
                               &moved_mount.offset[2],
                               top ? &m.polygon.top.tilt_x : &face.azimuth_error,
                               top ? &m.polygon.top.tilt_y : &face.tilt,
                               top ? &m.polygon.top.height : &face.distance,
                               &sensor.angles[0],
                               &sensor.angles[1],
                               &sensor.angles[2],
                               &sensor.position[0],
                               &sensor.position[1],
                               &sensor.position[2],
                               &sensor.exit[0],
                               &sensor.exit[1],
                               &sensor.exit[2]};
          *numbers[column] += step;
          return polygon_reading(reading, m.polygon, moved_mount, m.bench, position, moved_motion);
        };
        const double h = 1e-5;
        const double central = (moved(h) - moved(-h)) / (2 * h);
        EXPECT_NEAR(gradient[column], central, 1e-7 * (1 + std::abs(central))) << "reading " << i << " by " << column;
      }
    }
  }
}

TEST(PolygonTrace, ManyPositionsAtOnceEqualOneByOne) {
  const std::size_t n = 300;                // three blocks, the last not full
  for (const double size : {1e-3, 0.05}) {  // short series and full range
    test::PolygonCase c = random_polygon(12, size, 1, 23);
    c.mount.turn = 2 * std::numbers::pi / 12;
    RandomStream random(2);
    std::vector<double> angle(n);
    std::vector<std::vector<double>> motion(6, std::vector<double>(n));
    std::vector<std::uint16_t> face_x(n), face_y(n);
    std::vector<PolygonReadings> expected(n);
    for (std::size_t k = 0; k < n; ++k) {
      const PolygonPosition position = regular_position(12, k % 13, 1);
      const TableMotion m = random_motion(random, size, 1);
      angle[k] = position.angle;
      face_x[k] = static_cast<std::uint16_t>(position.face_x);
      face_y[k] = static_cast<std::uint16_t>(position.face_y);
      for (std::size_t i = 0; i < 3; ++i) {
        motion[i][k] = m.angles[static_cast<int>(i)];
        motion[3 + i][k] = m.displacement[static_cast<int>(i)];
      }
      expected[k] = polygon_readings(c.polygon, c.mount, c.bench, position, m);
    }
    PolygonPositions positions{n, angle.data(), {}, face_x.data(), face_y.data()};
    for (std::size_t i = 0; i < 6; ++i) positions.motion[i] = motion[i].data();
    std::vector<std::vector<double>> traced(kPolygonReadings, std::vector<double>(n));
    PolygonTraces traces{};
    for (std::size_t i = 0; i < kPolygonReadings; ++i) traces[i] = traced[i].data();
    const PolygonTrace tracer(c.polygon, c.mount, c.bench);
    tracer.trace(positions, traces);
    for (std::size_t k = 0; k < n; ++k)
      for (std::size_t i = 0; i < kPolygonReadings; ++i) {
        EXPECT_NEAR(traced[i][k], expected[k][i], i < 4 ? 2e-15 : 1e-13) << "position " << k << " reading " << i;
      }
    // One reading alone is the same, to the last bit.
    std::vector<double> alone(n);
    tracer.trace(positions, {nullptr, nullptr, nullptr, nullptr, nullptr, alone.data(), nullptr});
    EXPECT_EQ(alone, traced[5]);
  }
}

TEST(PolygonTrace, ABeamThatMissesItsFaceIsNoReading) {
  const Polygon polygon = regular_polygon(12, 48.3, 17);
  const PolygonTrace tracer(polygon, {}, {});
  const double angle = std::numbers::pi / 2;  // face 0 then looks along y
  const std::uint16_t face = 0;
  PolygonTraces traces{};
  double values[kPolygonReadings];
  for (std::size_t i = 0; i < kPolygonReadings; ++i) traces[i] = &values[i];
  tracer.trace({1, &angle, {}, &face, &face}, traces);
  EXPECT_TRUE(std::isnan(values[0]));
  EXPECT_FALSE(std::isnan(values[3]));
  EXPECT_TRUE(
      std::isnan(polygon_reading(PolygonReading::autocollimator_x_about_z, polygon, {}, {}, {angle, 0, 0}, {})));
}

TEST(Polygon, HalfTheFaceWidthOfThePaper) { EXPECT_NEAR(regular_polygon(12, 48.3, 17).half_face_width(), 12.94, 5e-3); }

TEST(Polygon, SetUpsThatCannotBeMeasuredAreRefused) {
  const Polygon polygon = regular_polygon(12, 48.3, 17);
  PolygonBench beside;
  beside.displacement_x.exit.y() = 13;
  EXPECT_THROW(validate(polygon, beside), std::invalid_argument);
  PolygonBench above;
  above.autocollimator_y.position.z() = 18;
  EXPECT_THROW(validate(polygon, above), std::invalid_argument);
  PolygonBench off_the_mirror;
  off_the_mirror.displacement_z.position.x() = 50;
  EXPECT_THROW(validate(polygon, off_the_mirror), std::invalid_argument);
  PolygonBench nan;
  nan.displacement_z.angles.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(validate(polygon, nan), std::invalid_argument);
  EXPECT_NO_THROW(validate(polygon, {}));
  EXPECT_THROW(regular_polygon(2, 48.3, 17), std::invalid_argument);
  EXPECT_THROW(regular_position(10, 0), std::invalid_argument);
}

}  // namespace
}  // namespace abbe
