#include "abbe/compensate/tables/anchored_lattice.h"

#include <gmock/gmock.h>

#include <cmath>
#include <random>

#include "abbe/compensate/point_correction.h"
#include "abbe/compensate/tables/line_tables.h"
#include "abbe/compensate/tables/whole_unit_correction.h"
#include "abbe/errors/random_errors.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

CorrectionLattice uneven_lattice() {
  CorrectionLattice lattice;
  lattice.inputs = {0, 2};
  lattice.positions = {{-50, -40, 10, 60, 100}, {0, 30, 60, 70}};
  lattice.modulo = {false, false};
  lattice.outputs = {1, 2};
  std::mt19937_64 generator(3);
  std::uniform_real_distribution<double> size(-0.04, 0.04);
  lattice.corrections.resize(2);
  for (std::vector<double>& values : lattice.corrections) {
    for (std::size_t k = 0; k < lattice.count(); ++k) values.push_back(size(generator));
  }
  return lattice;
}

TEST(AnchoredLattice, IsTheSameFunctionInsideTheTravelWhenItsOuterNodesLieFurtherOut) {
  const CorrectionLattice lattice = uneven_lattice();
  const CorrectionLattice further = continued_lattice(lattice, {{-90, -40, 10, 60, 110, 160}, {0, 30, 60, 90}});
  EXPECT_EQ(further.count(), 24U);
  std::mt19937_64 generator(4);
  std::uniform_real_distribution<double> x(-50, 100), z(0, 70);
  PoseList poses, wanted, found;
  for (int k = 0; k < 500; ++k) poses.append({x(generator), 0, z(generator)});
  LatticeCorrection(lattice).evaluate(poses, wanted);
  LatticeCorrection(further).evaluate(poses, found);
  for (std::size_t k = 0; k < poses.count(); ++k) {
    EXPECT_NEAR(found.axis[1][k], wanted.axis[1][k], 1e-15);
    EXPECT_NEAR(found.axis[2][k], wanted.axis[2][k], 1e-15);
  }
  // Beyond the first node outside it does not grow any more.
  for (std::size_t row = 0; row < 4; ++row) {
    EXPECT_EQ(further.corrections[0][6 * row + 5], further.corrections[0][6 * row + 4]);
  }
}

TEST(AnchoredLattice, KeepsToTheToleranceWithIntervalsOfFewDigitsAndNothingFromOutsideTheTravel) {
  const Machine machine = test::three_axis_mill();
  const ErrorSet errors = random_errors(machine, {});
  AnchoredLatticeOptions options;
  options.lattice.inputs = options.lattice.outputs = {0, 1, 2};
  options.lattice.reference = middle_of_travel(machine, errors);
  options.lattice.tolerance_mm = 5e-4;
  for (std::size_t i = 0; i < 3; ++i) {
    const KnownTravel travel = known_travel(machine, errors, i);
    options.anchor.push_back(travel.from + 0.2345 * static_cast<double>(i) * (travel.to - travel.from));
  }
  const AnchoredLattice made = build_anchored_lattice(machine, errors, options);
  ASSERT_TRUE(made.built.within);
  const LatticeFunction function(machine, errors, options.lattice);
  PoseList poses, wanted, found;
  std::mt19937_64 generator(8);
  for (int k = 0; k < 2000; ++k) poses.append(test::random_commands(machine, generator));
  function.evaluate(poses, wanted);
  LatticeCorrection(made.lattice).evaluate(poses, found);
  for (std::size_t i = 0; i < 3; ++i) {
    const AnchoredNodes& nodes = made.nodes[i];
    EXPECT_NEAR(nodes.interval / 1e-3, std::round(nodes.interval / 1e-3), 1e-6);
    EXPECT_EQ(nodes.positions[nodes.anchor], options.anchor[i]);
    const KnownTravel travel = known_travel(machine, errors, i);
    EXPECT_GE(made.built.lattice.positions[i].front(), travel.from);
    EXPECT_LE(made.built.lattice.positions[i].back(), travel.to);
    EXPECT_LE(made.lattice.positions[i].front(), travel.from + 1e-4);
    EXPECT_GE(made.lattice.positions[i].back(), travel.to - 1e-4);
    for (std::size_t k = 0; k < poses.count(); ++k) {
      EXPECT_NEAR(found.axis[i][k], wanted.axis[i][k], options.lattice.tolerance_mm);
    }
  }
}

TEST(AnchoredLattice, TakesNoMoreNodesThanThereIsRoomForAndSaysThatTheyAreTooFew) {
  const Machine machine = test::three_axis_mill();
  const ErrorSet errors = random_errors(machine, {});
  AnchoredLatticeOptions options;
  options.lattice.inputs = options.lattice.outputs = {0, 1, 2};
  options.lattice.reference = options.anchor = middle_of_travel(machine, errors);
  options.lattice.tolerance_mm = 1e-6;
  options.lattice.most_per_axis = 7;
  const AnchoredLattice few = build_anchored_lattice(machine, errors, options);
  for (const AnchoredNodes& nodes : few.nodes) EXPECT_LE(nodes.positions.size(), 7U);
  EXPECT_FALSE(few.built.within);
  options.lattice.most_nodes = 60;
  EXPECT_LE(build_anchored_lattice(machine, errors, options).lattice.count(), 60U);
  options.lattice.most_nodes = 2;
  EXPECT_EQ(build_anchored_lattice(machine, errors, options).lattice.count(), 27U);
}

TEST(AnchoredLattice, WholeUnitsAreAddedToTheNearest) {
  const WholeUnitCorrection rounded(std::make_unique<LatticeCorrection>(uneven_lattice()), 1e-3);
  PoseList poses, exact, found;
  for (int k = 0; k < 50; ++k) poses.append({-50 + 3.0 * k, 0, 1.3 * k});
  LatticeCorrection(uneven_lattice()).evaluate(poses, exact);
  rounded.evaluate(poses, found);
  double largest = 0;
  for (std::size_t k = 0; k < poses.count(); ++k) {
    EXPECT_NEAR(found.axis[1][k] / 1e-3, std::round(found.axis[1][k] / 1e-3), 1e-9);
    largest = std::max(largest, std::abs(found.axis[1][k] - exact.axis[1][k]));
  }
  EXPECT_LE(largest, 0.5e-3 + 1e-12);
  EXPECT_GT(largest, 0.3e-3);
}

}  // namespace
}  // namespace abbe
