#include "wang/study.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "wang/tables.h"

namespace abbe {
namespace {

TEST(WangStudy, ZeroPoseGivesTheCorrectedFigures) {
  // Column i = 1 of every table, B at its seventh position. Figures of an independent program (docs/reproduce.md).
  const Machine machine = wang_machine();
  const std::vector<double> zero = wang_zero_pose();
  const WangError degrees = wang_integrated_error(machine, wang_errors({}), zero);
  EXPECT_LE((degrees.machine - Eigen::Vector3d(-5.400842140, -5.349159759, 6.435605205)).norm(), 2e-9);
  const WangError millidegrees =
      wang_integrated_error(machine, wang_errors({.angles = WangAngleUnit::millidegrees, .composition = {}}), zero);
  EXPECT_LE((millidegrees.machine - Eigen::Vector3d(-0.004549911, -0.002405497, 0.009471109)).norm(), 2e-9);
  const WangError none =
      wang_integrated_error(machine, wang_errors({.angles = WangAngleUnit::none, .composition = {}}), zero);
  EXPECT_LE((none.machine - Eigen::Vector3d(0.001, 0.0027, 0.003)).norm(), 1e-12);
}

TEST(WangStudy, PopulationEqualsOneByOneEvaluation) {
  WangReading reading;
  reading.rows = 3;
  const WangPopulation population = wang_all_poses(reading);
  const Machine machine = wang_machine();
  const ErrorSet errors = wang_errors(reading);
  ASSERT_EQ(population.norm.count, 729U);
  double sum = 0, largest = 0;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  std::vector<std::size_t> rows(6);
  for (std::size_t n = 0; n < 729; ++n) {
    std::size_t rest = n;
    for (std::size_t& row : rows) {
      row = rest % 3;
      rest /= 3;
    }
    const Eigen::Vector3d error = wang_integrated_error(machine, errors, wang_positions(rows)).machine;
    sum += error.norm();
    largest = std::max(largest, error.norm());
    mean += error / 729;
  }
  EXPECT_NEAR(population.norm.mean, sum / 729, 1e-12);
  EXPECT_NEAR(population.norm.maximum, largest, 1e-12);
  EXPECT_LE((population.mean_components - mean).norm(), 1e-12);
  EXPECT_NEAR(wang_integrated_error(machine, errors, population.worst_pose).machine.norm(), largest, 1e-12);
}

TEST(WangStudy, ResultDoesNotDependOnTheNumberOfThreads) {
  WangReading reading;
  reading.rows = 4;
  const WangPopulation one = wang_all_poses(reading, 1), three = wang_all_poses(reading, 3);
  EXPECT_EQ(one.norm.mean, three.norm.mean);
  EXPECT_EQ(one.mean_components, three.mean_components);
}

TEST(WangTables, ConstantColumnsAndKnownEntriesAreAsPrinted) {
  EXPECT_EQ(wang_row(0, 10).dx, 7.4);
  EXPECT_EQ(wang_row(3, 0).position, 0);
  EXPECT_EQ(wang_row(4, 6).position, 0);
  EXPECT_EQ(wang_row(4, 6).dx, 5.6);
  for (std::size_t i = 0; i < 12; ++i) {
    EXPECT_EQ(wang_row(0, i).ey, 0.85943);
    EXPECT_EQ(wang_row(5, i).dz, 3.2);
  }
}

}  // namespace
}  // namespace abbe
