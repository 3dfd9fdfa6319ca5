#include "abbe/study/identification/sensor_selection.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "abbe/errors/random_stream.h"

namespace abbe {
namespace {

using Eigen::Index;

/// Readings and predictions of a model with two errors without a state and two terms for each of four sensors. The
/// third sensor carries nearly the course of the first, the fourth hardly acts on the displacement.
struct SensorCase {
  static constexpr Index kSensors = 4, kTerms = 2 + 2 * kSensors, kReadings = 60, kPoses = 50;
  SensorTerms terms;
  Eigen::MatrixXd rows{kReadings, kTerms}, predictions{3 * kPoses, kTerms};

  explicit SensorCase(double difference = 0.05) {
    terms.names = {"hall", "motor", "column", "coolant"};
    terms.needs = {{}, {}, {0}, {0}, {1}, {1}, {2}, {2}, {3}, {3}};
    terms.size.resize(kTerms);
    terms.size << 5, 5, 3, 3, 2, 2, 3, 3, 0.05, 0.05;
    fill(rows, kReadings, 1, 1, difference);
    fill(predictions, 3 * kPoses, 2, 1, difference);
    rows *= 4;  // over the uncertainty of a reading
  }
  SensorPrediction planned() const {
    return {rows.transpose() * rows, predictions.transpose() * predictions / static_cast<double>(kPoses)};
  }

 private:
  static void fill(Eigen::MatrixXd& to, Index count, std::uint64_t seed, double size, double difference) {
    for (Index k = 0; k < count; ++k) {
      RandomStream random(seed, static_cast<std::uint64_t>(k));
      const double at = static_cast<double>(k) / static_cast<double>(count);
      const double hall = std::sin(6 * at), motor = std::cos(9 * at), coolant = std::sin(23 * at);
      const double factor[kSensors] = {hall, motor, hall + difference * std::sin(31 * at), coolant};
      const double x = random.uniform(-1, 1), y = random.uniform(-1, 1);
      to(k, 0) = size;
      to(k, 1) = size * x;
      for (Index s = 0; s < kSensors; ++s) {
        to(k, 2 + 2 * s) = size * factor[s] * y;
        to(k, 3 + 2 * s) = size * factor[s] * x * y;
      }
    }
  }
};

/// The same figure with dense matrices and no algebra: errors are drawn, read, identified with what there is, and the
/// prediction is compared with the truth. The expectation over errors and noise is a sum over unit vectors.
double by_unit_vectors(const SensorCase& c, const std::vector<std::uint8_t>& has) {
  std::vector<Index> kept;
  for (Index p = 0; p < SensorCase::kTerms; ++p) {
    bool usable = true;
    for (const std::size_t sensor : c.terms.needs[static_cast<std::size_t>(p)]) usable = usable && has[sensor] != 0;
    if (usable) kept.push_back(p);
  }
  const auto n = static_cast<Index>(kept.size());
  // Readings, and behind them each kept error taken for zero within its size.
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(SensorCase::kReadings + n, n);
  Eigen::MatrixXd predictions(c.predictions.rows(), n);
  for (Index k = 0; k < n; ++k) {
    const Index p = kept[static_cast<std::size_t>(k)];
    a.col(k).head(SensorCase::kReadings) = c.rows.col(p);
    a(SensorCase::kReadings + k, k) = 1 / c.terms.size[p];
    predictions.col(k) = c.predictions.col(p);
  }
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(a);
  const auto error_of = [&](const Eigen::VectorXd& readings, const Eigen::VectorXd& truth) {
    Eigen::VectorXd right = Eigen::VectorXd::Zero(a.rows());
    right.head(SensorCase::kReadings) = readings;
    return (predictions * qr.solve(right) - truth).squaredNorm() / static_cast<double>(SensorCase::kPoses);
  };
  double sum = 0;
  for (Index p = 0; p < SensorCase::kTerms; ++p) {
    sum += error_of(c.rows.col(p) * c.terms.size[p], c.predictions.col(p) * c.terms.size[p]);
  }
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(c.predictions.rows());
  for (Index k = 0; k < SensorCase::kReadings; ++k)
    sum += error_of(Eigen::VectorXd::Unit(SensorCase::kReadings, k), none);
  return std::sqrt(sum);
}

std::vector<std::uint8_t> subset_of(unsigned bits) {
  std::vector<std::uint8_t> has;
  for (unsigned s = 0; s < SensorCase::kSensors; ++s) has.push_back((bits >> s & 1U) != 0 ? 1 : 0);
  return has;
}

TEST(SensorSelection, PredictsTheErrorOfEverySubsetAsSimulationsDo) {
  for (const double difference : {0.05, 0.0, 1.0}) {
    const SensorCase c(difference);
    const SensorPrediction planned = c.planned();
    for (unsigned bits = 0; bits < 16; ++bits) {
      const double expected = by_unit_vectors(c, subset_of(bits));
      EXPECT_NEAR(predicted_error(c.terms, planned, subset_of(bits)), expected, 1e-9 * expected) << bits;
    }
  }
}

TEST(SensorSelection, FindsTheBestSubsetsOfEveryNumber) {
  const SensorCase c(0.002);
  const SensorPrediction planned = c.planned();
  const auto error = [&](const std::vector<std::uint8_t>& has) { return predicted_error(c.terms, planned, has); };
  const SensorSelection found = select_sensors(c.terms.names, error);
  ASSERT_EQ(found.forward.size(), 4U);
  std::vector<double> best(5, 1e9);
  for (unsigned bits = 0; bits < 16; ++bits) {
    const std::vector<std::uint8_t> has = subset_of(bits);
    const auto number = static_cast<std::size_t>(std::count(has.begin(), has.end(), 1));
    best[number] = std::min(best[number], by_unit_vectors(c, has));
  }
  EXPECT_NEAR(found.none, best[0], 1e-9);
  for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(found.forward[k].error, best[k + 1], 1e-6) << k;
  EXPECT_NEAR(found.all, best[4], 1e-6);
  // Of two alike one is enough, and the coolant does nothing.
  EXPECT_EQ(found.enough, 2U);
  EXPECT_EQ(found.without.front().sensor, 1U) << "nothing stands in for the motor";
  EXPECT_LT(found.without.back().error, 1.01 * found.all);
  EXPECT_GT(found.without.front().error, 5 * found.all);
  for (const SensorStep& step : found.without) {
    std::vector<std::uint8_t> has(4, 1);
    has[step.sensor] = 0;
    EXPECT_NEAR(step.error, by_unit_vectors(c, has), 1e-6);
  }
}

TEST(SensorSelection, TheHeldOutErrorIsThatOfADenseFit) {
  const SensorCase c;
  SensorReadings readings{c.rows, Eigen::VectorXd(SensorCase::kReadings), {}};
  RandomStream random(7);
  Eigen::VectorXd truth(SensorCase::kTerms);
  for (Index p = 0; p < truth.size(); ++p) truth[p] = c.terms.size[p] * random.uniform(-1.5, 1.5);
  readings.values = c.rows * truth;
  for (Index k = 0; k < SensorCase::kReadings; ++k) {
    readings.values[k] += random.uniform(-1.7, 1.7);
    readings.held_out.push_back(k % 4 == 1 ? 1 : 0);
  }
  std::vector<double> errors;
  for (unsigned bits = 0; bits < 16; ++bits) {
    const std::vector<std::uint8_t> has = subset_of(bits);
    // Columns that cannot be used are known to be zero.
    std::vector<Index> used;
    for (Index k = 0; k < SensorCase::kReadings; ++k)
      if (readings.held_out[static_cast<std::size_t>(k)] == 0) used.push_back(k);
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(static_cast<Index>(used.size()) + SensorCase::kTerms, SensorCase::kTerms);
    Eigen::VectorXd b = Eigen::VectorXd::Zero(a.rows());
    Eigen::MatrixXd rows = c.rows;
    for (Index p = 0; p < SensorCase::kTerms; ++p) {
      for (const std::size_t sensor : c.terms.needs[static_cast<std::size_t>(p)])
        if (has[sensor] == 0) rows.col(p).setZero();
      a(static_cast<Index>(used.size()) + p, p) = 1 / c.terms.size[p];
    }
    for (std::size_t k = 0; k < used.size(); ++k) {
      a.row(static_cast<Index>(k)) = rows.row(used[k]);
      b[static_cast<Index>(k)] = readings.values[used[k]];
    }
    const Eigen::VectorXd rest = readings.values - rows * Eigen::VectorXd(a.householderQr().solve(b));
    double sum = 0, count = 0;
    for (Index k = 0; k < rest.size(); ++k) {
      if (readings.held_out[static_cast<std::size_t>(k)] == 0) continue;
      sum += rest[k] * rest[k];
      ++count;
    }
    errors.push_back(held_out_error(c.terms, readings, has));
    EXPECT_NEAR(errors.back(), std::sqrt(sum / count), 1e-8 * errors.back()) << bits;
  }
  const SensorSelection found = select_sensors(
      c.terms.names, [&](const std::vector<std::uint8_t>& has) { return held_out_error(c.terms, readings, has); });
  EXPECT_DOUBLE_EQ(found.all, errors[15]);
  EXPECT_DOUBLE_EQ(found.none, errors[0]);
  EXPECT_DOUBLE_EQ(found.forward[0].error, std::min({errors[1], errors[2], errors[4], errors[8]}));
  readings.held_out.assign(readings.held_out.size(), 0);
  EXPECT_THROW(held_out_error(c.terms, readings, {1, 1, 1, 1}), std::invalid_argument);
}

TEST(SensorSelection, SaysWhichCoursesFollowFromOthers) {
  Eigen::MatrixXd course(100, 5);
  for (Index k = 0; k < course.rows(); ++k) {
    const double at = static_cast<double>(k) / 99;
    course(k, 0) = 20 + 3 * std::sin(7 * at);
    course(k, 1) = 30 + 5 * std::cos(11 * at);
    course(k, 2) = 21 + 2.5 * std::sin(7 * at) + 0.02 * std::sin(90 * at);  // as the first
    course(k, 3) = course(k, 0) + course(k, 1) + 0.1 * std::cos(70 * at);   // from both
    course(k, 4) = 22.5;
  }
  const std::vector<SensorLikeness> alike = like_sensors(course);
  const auto of = [&](std::size_t sensor) {
    return std::find_if(alike.begin(), alike.end(), [&](const SensorLikeness& one) { return one.sensor == sensor; });
  };
  ASSERT_NE(of(0), alike.end());
  EXPECT_EQ(of(0)->other, 2U);
  EXPECT_NEAR(of(2)->left, 0.02 / std::sqrt(2), 0.002);
  EXPECT_EQ(of(2)->other, 0U);
  ASSERT_NE(of(3), alike.end());
  EXPECT_EQ(of(3)->other, SensorLikeness::kAllOthers);
  EXPECT_NEAR(of(3)->left, 0.1 / std::sqrt(2), 0.01);
  ASSERT_NE(of(4), alike.end());
  EXPECT_TRUE(of(4)->still());
  EXPECT_TRUE(like_sensors(course.leftCols(2)).empty());
}

TEST(SensorSelection, RefusesSizesThatDoNotAgree) {
  const SensorCase c;
  EXPECT_THROW(predicted_error(c.terms, c.planned(), {1, 1}), std::invalid_argument);
  EXPECT_THROW(predicted_error(c.terms, {}, {1, 1, 1, 1}), std::invalid_argument);
  EXPECT_THROW(held_out_error(c.terms, {}, {1, 1, 1, 1}), std::invalid_argument);
}

}  // namespace
}  // namespace abbe
