#include "abbe/identify/trust/shown_by.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "abbe/geometry/angle_units.h"
#include "abbe/identify/gauge_convention.h"
#include "abbe/instruments/electronic_level.h"
#include "abbe/instruments/instrument_observations.h"
#include "abbe/instruments/instrument_simulation.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

using Eigen::Vector3d;
using ::testing::HasSubstr;

/// A relative level on the body that moves, read over the travel of one axis; error motions of that axis.
class LevelStudy {
 public:
  LevelStudy(const Machine& machine, std::size_t axis, const std::vector<Component>& components, const Basis& basis) {
    ElectronicLevelSetup setup;
    setup.relative = true;
    setup.axes = {{"along_x", Vector3d::UnitX(), SetupNumber::open(0)},
                  {"along_y", Vector3d::UnitY(), SetupNumber::open(0)}};
    const auto level = std::make_shared<ElectronicLevel>(setup);
    ErrorSet errors;
    for (const Component component : components) {
      errors.motions.push_back({axis, component, basis, std::vector<double>(basis.size(), 0.0), {}});
    }
    InstrumentReadings plan;
    plan.poses.axis.resize(machine.axes.size());
    for (int k = 0; k < 24; ++k) {
      std::vector<double> pose(machine.axes.size(), 0.0);
      pose[axis] = basis.from + (basis.to - basis.from) * k / 24;
      plan.append(pose, 0);
    }
    const InstrumentReadings readings = simulate_instrument(machine, errors, level, plan, {}).readings;
    observations_ = std::make_unique<InstrumentObservations>(machine, errors, level, readings);
    problem = estimate_everything(machine, errors, {borrowed(*observations_)});
    problem.machine_parameters.resize(problem.machine_parameters.size() - 3);  // the tool offset error comes last
  }
  Problem problem;

 private:
  std::unique_ptr<InstrumentObservations> observations_;
};

TEST(ShownBy, TellsWhatTheReadingsShowFromWhatAnotherInstrumentWould) {
  const Machine machine = test::three_axis_mill();
  const Basis basis{BasisKind::legendre, 3, machine.axes[0].travel_min, machine.axes[0].travel_max};
  const LevelStudy study(machine, 0,
                         {Component::A, Component::B, Component::C, Component::X, Component::Y, Component::Z}, basis);
  // Second and third order of each: a constant is no more than how the table lies.
  const std::vector<ShownBy> shown =
      shown_by(study.problem, {{2, 3}, {6, 7}, {10, 11}, {14, 15}}, possible_measurements(study.problem));
  ASSERT_EQ(shown.size(), 4U);
  EXPECT_TRUE(shown[0].by_readings);
  EXPECT_TRUE(shown[1].by_readings);
  EXPECT_FALSE(shown[2].by_readings);
  EXPECT_TRUE(shown[2].shown);
  EXPECT_THAT(shown[2].remedy, HasSubstr("a laser interferometer along X (angles)"));
  EXPECT_FALSE(shown[3].by_readings);
  EXPECT_THAT(shown[3].remedy, HasSubstr("a laser interferometer along X"));
}

TEST(ShownBy, WithoutAnythingToTryNothingIsShown) {
  const Machine machine = test::three_axis_mill();
  const Basis basis{BasisKind::legendre, 3, machine.axes[0].travel_min, machine.axes[0].travel_max};
  const LevelStudy study(machine, 0, {Component::A, Component::C}, basis);
  const std::vector<ShownBy> shown = shown_by(study.problem, {{2, 3}, {6, 7}}, {});
  EXPECT_TRUE(shown[0].by_readings);
  EXPECT_FALSE(shown[1].by_readings);
  EXPECT_FALSE(shown[1].shown);
}

TEST(ShownBy, APolygonPrismShowsWhatALevelOnARotaryTableDoesNot) {
  const Machine machine = test::rotary_table();
  Basis basis{BasisKind::fourier, 2, 0, kTurn};
  basis.period = kTurn;
  const LevelStudy study(machine, 0,
                         {Component::A, Component::B, Component::C, Component::X, Component::Y, Component::Z}, basis);
  // Second harmonics. The level turns with the table and sees what it leans to.
  const std::vector<ShownBy> shown =
      shown_by(study.problem, {{3, 4}, {8, 9}, {13, 14}, {18, 19}}, possible_measurements(study.problem));
  EXPECT_TRUE(shown[0].by_readings);
  EXPECT_TRUE(shown[1].by_readings);
  for (const std::size_t i : {2U, 3U}) {
    EXPECT_FALSE(shown[i].by_readings);
    EXPECT_TRUE(shown[i].shown);
    EXPECT_THAT(shown[i].remedy, HasSubstr("a polygon prism on the table"));
  }
}

/// Largest entries of the conventions about what turns with or against an axis, applied to a table with an eccentric
/// cylinder: it turns with the table.
double eccentricity(const Machine& machine, const std::string& words) {
  Basis basis{BasisKind::fourier, 1, 0, kTurn};
  basis.period = kTurn;
  ErrorSet errors;
  const double sense = machine.axes[0].sense();
  // Rotated by the position of the table: radius 1 um, in X and in Y.
  errors.motions.push_back({0, Component::X, basis, {0, 1e-3, 0}, {}});
  errors.motions.push_back({0, Component::Y, basis, {0, 0, sense * 1e-3}, {}});
  Problem problem = estimate_everything(machine, errors, {});
  problem.machine_parameters.resize(6);
  const Eigen::VectorXd estimates = Eigen::VectorXd::Map(errors.parameters().data(), 6);
  double largest = -1;
  for (const GaugeCandidate& candidate : gauge_candidates(problem, estimates)) {
    if (candidate.words.find("turning " + words) == std::string::npos) continue;
    largest = std::max(largest, std::abs(candidate.functional.dot(estimates)));
  }
  return largest;
}

TEST(GaugeWords, WhatIsFixedToATableTurnsWithItWhicheverWayACommandTurnsIt) {
  Machine machine = test::rotary_table();
  ASSERT_FALSE(machine.axes[0].primed);
  EXPECT_NEAR(eccentricity(machine, "with C "), 1e-3, 1e-9);
  EXPECT_NEAR(eccentricity(machine, "against C "), 0, 1e-9);
  machine.axes[0].primed = true;
  EXPECT_NEAR(eccentricity(machine, "with C' "), 1e-3, 1e-9);
  EXPECT_NEAR(eccentricity(machine, "against C' "), 0, 1e-9);
}

}  // namespace
}  // namespace abbe
