#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "abbe/identify/linkage/dial_decoupling.h"

namespace abbe {
namespace {

using testing::Contains;
using testing::HasSubstr;

/// Two dials at right angles at each of two heights of a mandrel, one on its end, over whole turns in equal steps.
AxisIndications mandrel(std::size_t direction, std::size_t count, double span, double sense = 1) {
  AxisIndications readings;
  readings.kind = AxisKind::rotary;
  readings.direction = direction;
  readings.sense = sense;
  for (std::size_t i = 0; i < count; ++i) {
    readings.positions.push_back(span * static_cast<double>(i) / static_cast<double>(count));
  }
  const Eigen::Vector3d along = Eigen::Vector3d::Unit(static_cast<Eigen::Index>(direction));
  for (std::size_t side : {1U, 2U}) {
    for (double height : {20.0, 150.0}) {
      DisplacementProbe probe;
      probe.direction = Eigen::Vector3d::Unit(static_cast<Eigen::Index>((direction + side) % 3));
      probe.place = height * along + 15 * probe.direction;
      probe.standard_uncertainty = 0.0006;
      readings.probes.push_back(probe);
    }
  }
  DisplacementProbe end;
  end.direction = along;
  end.place = 180 * along;
  end.standard_uncertainty = 11e-6;
  readings.probes.push_back(end);
  readings.indications = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(count), 5);
  return readings;
}

/// An eccentric and wobbling mandrel, as the probes see it without any error of the axis: small angles, first order.
void add_mandrel(AxisIndications& readings) {
  const std::size_t d = readings.direction;
  const Eigen::Index first = static_cast<Eigen::Index>((d + 1) % 3), second = static_cast<Eigen::Index>((d + 2) % 3);
  for (std::size_t i = 0; i < readings.positions.size(); ++i) {
    const double c = std::cos(readings.sense * readings.positions[i]),
                 s = std::sin(readings.sense * readings.positions[i]);
    for (std::size_t j = 0; j < readings.probes.size(); ++j) {
      const DisplacementProbe& probe = readings.probes[j];
      const double height = probe.place[static_cast<Eigen::Index>(d)];
      const double e = 0.02 + 5e-5 * height, f = -0.01 + 3e-5 * height;  // of the mandrel's axis in its own frame
      Eigen::Vector3d moved = Eigen::Vector3d::Zero();
      moved[first] = e * c - f * s;
      moved[second] = e * s + f * c;
      readings.indications(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) += moved.dot(probe.direction);
    }
  }
}

TEST(RotaryDecoupling, EccentricityAndWobbleOfTheMandrelGoAndErrorMotionsStay) {
  for (std::size_t direction : {0U, 1U, 2U}) {
    for (double sense : {1.0, -1.0}) {
      AxisIndications readings = mandrel(direction, 12, 2 * std::numbers::pi, sense);
      // Second and higher harmonics, and what turns against the axis once per turn: none of it is the mandrel's.
      Eigen::MatrixXd truth = Eigen::MatrixXd::Zero(12, 6);
      const Eigen::Index d = static_cast<Eigen::Index>(direction), first = (d + 1) % 3, second = (d + 2) % 3;
      for (Eigen::Index i = 0; i < 12; ++i) {
        const double a = sense * readings.positions[static_cast<std::size_t>(i)];
        truth(i, first) = 0.003 * std::cos(2 * a + 0.3) + 0.002 * std::cos(a);
        truth(i, second) = 0.001 * std::sin(3 * a) - 0.002 * std::sin(a);
        truth(i, 3 + first) = 1e-5 * std::cos(2 * a);
        truth(i, 3 + second) = 2e-5 * std::sin(2 * a + 1);
        truth(i, d) = 0.001 * std::sin(a);
      }
      readings.indications = exact_indications(readings, truth);
      add_mandrel(readings);
      const Decoupling result = decouple_indications(readings);
      ASSERT_EQ(result.status, DecouplingStatus::ok) << result.message;
      EXPECT_LE((result.errors.leftCols(3) - truth.leftCols(3)).cwiseAbs().maxCoeff(), 1e-7);
      EXPECT_LE((result.errors.rightCols(3) - truth.rightCols(3)).cwiseAbs().maxCoeff(), 1e-9);
      EXPECT_FALSE(result.seen[3 + direction]) << "a mandrel does not show how far it is turned";
      EXPECT_THAT(result.notes, Contains(HasSubstr("a polygon with autocollimator")));
      // Eccentricity at height 0 as (cos, sin) of what turns with the axis.
      EXPECT_NEAR(result.removed[(direction + 1) % 3][1], 0.02, 1e-7);
      EXPECT_NEAR(result.removed[(direction + 1) % 3][2], -0.01, 1e-7);
    }
  }
}

TEST(RotaryDecoupling, CovarianceIsThatOfTheLinearMapOfTheReadings) {
  AxisIndications readings = mandrel(1, 5, 1.5);
  const Eigen::Index m = 5, k = 5;
  Eigen::MatrixXd map(6 * m, m * k);
  Eigen::VectorXd variance(m * k);
  for (Eigen::Index i = 0; i < m; ++i) {
    for (Eigen::Index j = 0; j < k; ++j) {
      readings.indications.setZero();
      readings.indications(i, j) = 1;
      map.col(i * k + j) = decouple_indications(readings).errors.reshaped();
      variance[i * k + j] = std::pow(readings.probes[static_cast<std::size_t>(j)].standard_uncertainty, 2);
    }
  }
  const Eigen::MatrixXd expected = map * variance.asDiagonal() * map.transpose();
  const Decoupling result = decouple_indications(readings);
  EXPECT_LE((result.covariance - expected).cwiseAbs().maxCoeff(), 1e-10 * expected.cwiseAbs().maxCoeff());
  EXPECT_THAT(result.notes, Contains(HasSubstr("over 69 deg of travel")));
}

TEST(RotaryDecoupling, OneDialLosesTheWholeFirstHarmonic) {
  AxisIndications readings = mandrel(2, 12, 2 * std::numbers::pi);
  readings.probes.erase(readings.probes.begin() + 1, readings.probes.end());
  readings.indications.resize(12, 1);
  for (Eigen::Index i = 0; i < 12; ++i) {
    const double a = readings.positions[static_cast<std::size_t>(i)];
    readings.indications(i, 0) = 0.01 + 0.004 * std::cos(a) - 0.003 * std::sin(a) + 0.002 * std::cos(2 * a);
  }
  const Decoupling result = decouple_indications(readings);
  ASSERT_EQ(result.status, DecouplingStatus::ok);
  for (Eigen::Index i = 0; i < 12; ++i) {
    EXPECT_NEAR(result.errors(i, 0), 0.002 * std::cos(2 * readings.positions[static_cast<std::size_t>(i)]), 1e-15);
  }
  EXPECT_THAT(result.notes, Contains(HasSubstr("EXC is that at the probes: it contains 20 mm x EBC")));
}

TEST(RotaryDecoupling, ThreePositionsOfOneDialAreAllDatum) {
  AxisIndications readings = mandrel(2, 3, 2 * std::numbers::pi);
  readings.probes.erase(readings.probes.begin() + 1, readings.probes.end());
  readings.indications = Eigen::MatrixXd::Constant(3, 1, 0.001);
  const Decoupling result = decouple_indications(readings);
  EXPECT_EQ(result.status, DecouplingStatus::too_few_positions);
  EXPECT_EQ(result.message, "3 positions; the datum removes everything that is seen of EXC");
  EXPECT_EQ(result.errors.size(), 0);
}

}  // namespace
}  // namespace abbe
