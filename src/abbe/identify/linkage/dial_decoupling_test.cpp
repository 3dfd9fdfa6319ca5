#include "abbe/identify/linkage/dial_decoupling.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "abbe/errors/random_stream.h"

namespace abbe {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

DisplacementProbe probe(std::size_t direction, const Eigen::Vector3d& place, double standard_uncertainty = 0.0006) {
  DisplacementProbe result;
  result.direction = Eigen::Vector3d::Unit(static_cast<Eigen::Index>(direction));
  result.place = place;
  result.standard_uncertainty = standard_uncertainty;
  return result;
}

/// Four dials on the face with normal Z, three on the one with normal Y, a laser along X above the table.
AxisIndications carriage(std::vector<double> positions) {
  AxisIndications readings;
  readings.positions = std::move(positions);
  for (double u : {-60.0, 60.0}) {
    for (double v : {-40.0, 40.0}) readings.probes.push_back(probe(2, {u, v, 30}));
  }
  readings.probes.push_back(probe(1, {-60, 50, -30}));
  readings.probes.push_back(probe(1, {60, 50, -30}));
  readings.probes.push_back(probe(1, {0, 50, 30}));
  readings.probes.push_back(probe(0, {0, -20, 80}, 11e-6));
  readings.indications = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(readings.positions.size()), 8);
  return readings;
}

Eigen::MatrixXd random_errors(Eigen::Index count, std::uint64_t seed) {
  RandomStream random(seed);
  Eigen::MatrixXd errors(count, 6);
  for (Eigen::Index i = 0; i < count; ++i) {
    for (Eigen::Index c = 0; c < 6; ++c) errors(i, c) = (c < 3 ? 0.004 : 2e-5) * random.normal();
  }
  return errors;
}

/// Without its least-squares line: written out, not by the code under test.
Eigen::VectorXd straight(const std::vector<double>& x, const Eigen::VectorXd& v) {
  double n = static_cast<double>(x.size()), sx = 0, sxx = 0, sv = 0, sxv = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double value = v[static_cast<Eigen::Index>(i)];
    sx += x[i];
    sxx += x[i] * x[i];
    sv += value;
    sxv += x[i] * value;
  }
  const double slope = (n * sxv - sx * sv) / (n * sxx - sx * sx), constant = (sv - slope * sx) / n;
  Eigen::VectorXd result = v;
  for (std::size_t i = 0; i < x.size(); ++i) result[static_cast<Eigen::Index>(i)] -= constant + slope * x[i];
  return result;
}

TEST(DialDecoupling, SevenDialsAndALaserGiveAllSixErrors) {
  AxisIndications readings = carriage({0, 40, 80, 120, 160});
  const Eigen::MatrixXd truth = random_errors(5, 11);
  readings.indications = exact_indications(readings, truth);
  const Decoupling result = decouple_indications(readings);
  ASSERT_EQ(result.status, DecouplingStatus::ok) << result.message;
  EXPECT_TRUE(result.notes.empty());
  // Second order in the angles: (4e-5)^2 x 100 mm.
  constexpr double kSecondOrder = 2e-7;
  EXPECT_LE((result.errors.col(0) - truth.col(0)).cwiseAbs().maxCoeff(), kSecondOrder);
  for (Eigen::Index c : {1, 2}) {
    EXPECT_LE((result.errors.col(c) - straight(readings.positions, truth.col(c))).cwiseAbs().maxCoeff(), kSecondOrder);
  }
  EXPECT_LE((result.errors.rightCols(3) - truth.rightCols(3)).cwiseAbs().maxCoeff(), kSecondOrder / 30);
  EXPECT_LE(result.chi_square, 1e-3);
  EXPECT_EQ(result.degrees_of_freedom, 4U * 2U);
}

TEST(DialDecoupling, ZerosOfDialsAndTiltOfTheFaceStayOutOfStraightness) {
  AxisIndications readings = carriage({0, 40, 80, 120, 160});
  const Eigen::MatrixXd truth = random_errors(5, 12);
  const Decoupling clean = [&] {
    readings.indications = exact_indications(readings, truth);
    return decouple_indications(readings, AngleDatum::zero_at_first_position);
  }();
  for (Eigen::Index i = 0; i < 5; ++i) {
    for (Eigen::Index j = 0; j < 7; ++j) {
      readings.indications(i, j) +=
          0.01 * static_cast<double>(j * j) + (j < 4 ? 30e-6 : -20e-6) * 40 * static_cast<double>(i);
    }
  }
  const Decoupling shifted = decouple_indications(readings, AngleDatum::zero_at_first_position);
  EXPECT_LE((shifted.errors.rightCols(5) - clean.errors.rightCols(5)).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_NEAR(shifted.chi_square, clean.chi_square, 1e-9) << "a constant per dial is no misfit";
  EXPECT_GT(shifted.probe_offset.cwiseAbs().maxCoeff(), 0.001);
  EXPECT_EQ(shifted.errors(0, 4), 0);
  EXPECT_EQ(shifted.standard_uncertainty(Component::B, 0), 0);
}

TEST(DialDecoupling, CovarianceIsThatOfTheLinearMapOfTheReadings) {
  for (AngleDatum datum : {AngleDatum::as_indicated, AngleDatum::zero_at_first_position, AngleDatum::zero_mean}) {
    AxisIndications readings = carriage({0, 40, 90, 160});
    const Eigen::Index m = 4, k = 8;
    Eigen::MatrixXd map(6 * m, m * k);
    Eigen::VectorXd variance(m * k);
    for (Eigen::Index i = 0; i < m; ++i) {
      for (Eigen::Index j = 0; j < k; ++j) {
        readings.indications.setZero();
        readings.indications(i, j) = 1;
        map.col(i * k + j) = decouple_indications(readings, datum).errors.reshaped();
        variance[i * k + j] = std::pow(readings.probes[static_cast<std::size_t>(j)].standard_uncertainty, 2);
      }
    }
    const Eigen::MatrixXd expected = map * variance.asDiagonal() * map.transpose();
    const Eigen::MatrixXd covariance = decouple_indications(readings, datum).covariance;
    EXPECT_LE((covariance - expected).cwiseAbs().maxCoeff(), 1e-12 * expected.cwiseAbs().maxCoeff());
    // Angles beside lengths: the small ones too.
    EXPECT_NEAR(covariance(5 * m + 1, 5 * m + 1), expected(5 * m + 1, 5 * m + 1),
                1e-9 * expected(5 * m + 1, 5 * m + 1));
  }
}

TEST(DialDecoupling, MonteCarloGivesTheStatedCovarianceAndChiSquare) {
  AxisIndications readings = carriage({0, 40, 90, 160});
  const Eigen::MatrixXd clean = exact_indications(readings, random_errors(4, 5));
  readings.indications = clean;
  const Decoupling truth = decouple_indications(readings);
  constexpr int kCampaigns = 1200;
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(24, 24);
  double chi_square = 0;
  for (int campaign = 0; campaign < kCampaigns; ++campaign) {
    RandomStream random(99, static_cast<std::uint64_t>(campaign));
    for (Eigen::Index i = 0; i < 4; ++i) {
      for (Eigen::Index j = 0; j < 8; ++j) {
        readings.indications(i, j) =
            clean(i, j) + readings.probes[static_cast<std::size_t>(j)].standard_uncertainty * random.normal();
      }
    }
    const Decoupling found = decouple_indications(readings);
    const Eigen::VectorXd off = (found.errors - truth.errors).reshaped();
    sum += off * off.transpose() / kCampaigns;
    chi_square += found.chi_square / kCampaigns;
  }
  const Eigen::VectorXd u = truth.covariance.diagonal().cwiseSqrt();
  // A sample correlation of 1200 scatters by at most sqrt(2 / 1200) = 0.041.
  for (Eigen::Index a = 0; a < 24; ++a) {
    for (Eigen::Index b = 0; b <= a; ++b) {
      EXPECT_NEAR(sum(a, b) / (u[a] * u[b]), truth.covariance(a, b) / (u[a] * u[b]), 0.17) << a << " " << b;
    }
    EXPECT_NEAR(std::sqrt(sum(a, a)) / u[a], 1, 0.085) << a;
  }
  EXPECT_NEAR(chi_square, static_cast<double>(truth.degrees_of_freedom), 4 * std::sqrt(2.0 * 6 / kCampaigns));
}

TEST(DialDecoupling, ThreeDialsOnOneFaceSeeStraightnessRollAndPitch) {
  AxisIndications readings;
  readings.positions = {0, 10, 20};
  for (const Eigen::Vector3d& place : {Eigen::Vector3d(-50, 0, 0), {50, 0, 0}, {0, 60, 0}}) {
    readings.probes.push_back(probe(2, place));
  }
  const Eigen::MatrixXd truth = random_errors(3, 2);
  readings.indications = exact_indications(readings, truth);
  const Decoupling result = decouple_indications(readings);
  ASSERT_EQ(result.status, DecouplingStatus::ok);
  const std::array<bool, 6> seen = {false, false, true, true, true, false};
  EXPECT_EQ(result.seen, seen);
  EXPECT_LE((result.errors.middleCols(3, 2) - truth.middleCols(3, 2)).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_THAT(result.notes, Contains("ECX is not seen; it takes probes at two places along the motion at once"));
  EXPECT_THAT(result.notes, Contains("EXX is not seen; it takes a laser interferometer or a dial along the axis"));
}

TEST(DialDecoupling, DialsOnOneLineAreACombinationNotAFigure) {
  AxisIndications readings;
  readings.positions = {0, 10, 20};
  for (double at : {-50.0, 0.0, 50.0}) readings.probes.push_back(probe(2, {at, 2 * at + 7, 0}));
  readings.indications = Eigen::MatrixXd::Constant(3, 3, 0.001);
  const Decoupling result = decouple_indications(readings);
  EXPECT_EQ(result.status, DecouplingStatus::combination_only);
  EXPECT_THAT(result.message, AllOf(HasSubstr("EZX, EAX, EBX"), HasSubstr("one line")));
  EXPECT_EQ(result.errors.size(), 0);
}

TEST(DialDecoupling, OneDialOffTheReferenceSaysWhatItContains) {
  AxisIndications readings;
  readings.positions = {0, 10, 20, 30};
  for (double v : {0.0, 40.0}) readings.probes.push_back(probe(2, {50, v, 0}));
  readings.indications = Eigen::MatrixXd::Zero(4, 2);
  const Decoupling result = decouple_indications(readings);
  ASSERT_EQ(result.status, DecouplingStatus::ok);
  EXPECT_FALSE(result.seen[4]);
  EXPECT_THAT(result.notes, Contains("EZX is that at the probes: it contains -50 mm x EBX, which is not seen"));
}

TEST(DialDecoupling, TooFewPositionsAndNoProbesAreStatuses) {
  AxisIndications readings = carriage({0, 40});
  EXPECT_EQ(decouple_indications(readings).status, DecouplingStatus::too_few_positions);
  readings.probes.clear();
  readings.indications.resize(2, 0);
  EXPECT_EQ(decouple_indications(readings).status, DecouplingStatus::nothing_seen);
}

TEST(DialDecoupling, RefusesWhatIsNoReading) {
  AxisIndications readings = carriage({0, 40, 40});
  EXPECT_THROW(decouple_indications(readings), std::invalid_argument);
  readings = carriage({0, 40, 80});
  readings.probes[0].standard_uncertainty = 0;
  EXPECT_THROW(decouple_indications(readings), std::invalid_argument);
  readings = carriage({0, 40, 80});
  readings.probes[0].direction *= 2;
  EXPECT_THROW(decouple_indications(readings), std::invalid_argument);
  readings = carriage({0, 40, 80});
  readings.indications.conservativeResize(2, 8);
  EXPECT_THROW(decouple_indications(readings), std::invalid_argument);
}

}  // namespace
}  // namespace abbe
