#include "abbe/errors/chain_plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <thread>

#include "abbe/errors/chain_plan_cases.h"

namespace abbe {
namespace {

using chain_cases::Batch;
using chain_cases::bed_from_body;
using chain_cases::Case;
using chain_cases::kBodies;
using chain_cases::kOrders;
using chain_cases::random_case;

void expect_as_actual_pose(const Case& c, std::uint64_t seed, double tolerance_mm, double tolerance_rad) {
  RandomStream random(seed, 8);
  for (const Body from : kBodies) {
    for (const Body to : kBodies) {
      const ChainPlan plan(c.machine, c.errors, from, to);
      Batch batch(c.machine, 17, random);
      batch.transform(plan);
      for (std::size_t k = 0; k < batch.count(); ++k) {
        const std::vector<double> positions = batch.positions_of(k);
        const RigidTransform expected =
            from == to ? RigidTransform{}
                       : bed_from_body(c, positions, to).inverse() * bed_from_body(c, positions, from);
        EXPECT_LE((batch.seen_point(k) - expected * batch.start_point(k)).cwiseAbs().maxCoeff(), tolerance_mm)
            << "seed " << seed << " from " << static_cast<int>(from) << " to " << static_cast<int>(to);
        EXPECT_LE((batch.rotation_matrix(k) - expected.rotation).cwiseAbs().maxCoeff(), tolerance_rad);
        EXPECT_EQ(batch.covered[k], 1);
      }
    }
  }
}

TEST(ChainPlan, AgreesWithTheActualPoseOnRandomMachinesWithAllBases) {
  for (std::uint64_t seed = 0; seed < 60; ++seed) expect_as_actual_pose(random_case(seed, 0.1), seed, 1e-12, 4e-15);
}

TEST(ChainPlan, AgreesInEveryOrderOfErrorAndMotion) {
  for (const ErrorOrder order : kOrders) {
    for (std::uint64_t seed = 100; seed < 120; ++seed) {
      expect_as_actual_pose(random_case(seed, 0.1, order), seed, 1e-12, 4e-15);
    }
  }
}

TEST(ChainPlan, AgreesForAnglesFarBeyondSmall) {
  for (std::uint64_t seed = 200; seed < 220; ++seed) expect_as_actual_pose(random_case(seed, 30), seed, 5e-10, 2e-12);
}

TEST(ChainPlan, GivesTheNominalPoseWithoutErrors) {
  for (std::uint64_t seed = 300; seed < 330; ++seed) {
    Case c = random_case(seed, 0.0);
    if (seed % 2 == 0) c.errors.motions.clear(), c.errors.locations.clear();
    RandomStream random(seed);
    Batch batch(c.machine, 5, random);
    batch.transform(ChainPlan(c.machine, c.errors, Body::tool, Body::workpiece));
    for (std::size_t k = 0; k < batch.count(); ++k) {
      const RigidTransform expected = nominal_workpiece_from_tool(c.machine, batch.positions_of(k)) *
                                      RigidTransform::translate(-c.machine.tool_offset);
      EXPECT_LE((batch.seen_point(k) - expected * batch.start_point(k)).norm(), 1e-12);
      EXPECT_LE((batch.rotation_matrix(k) - expected.rotation).norm(), 2e-14);
    }
  }
}

TEST(ChainPlan, KeepsTheFirstOrderFormTowardsTheBedAndInvertsIt) {
  for (const ErrorOrder order : kOrders) {
    for (std::uint64_t seed = 400; seed < 420; ++seed) {
      Case c = random_case(seed, 1.0, order);
      c.errors.composition.first_order = true;
      RandomStream random(seed);
      for (const Body body : {Body::tool, Body::workpiece}) {
        Batch out(c.machine, 9, random);
        out.transform(ChainPlan(c.machine, c.errors, body, Body::bed));
        Batch back = out;
        back.start = out.seen;
        back.transform(ChainPlan(c.machine, c.errors, Body::bed, body));
        for (std::size_t k = 0; k < out.count(); ++k) {
          const RigidTransform expected = bed_from_body(c, out.positions_of(k), body);
          EXPECT_LE((out.seen_point(k) - expected * out.start_point(k)).norm(), 1e-11);
          EXPECT_LE((out.rotation_matrix(k) - expected.rotation).norm(), 2e-14);
          EXPECT_LE((back.seen_point(k) - out.start_point(k)).norm(), 4e-12);
        }
      }
    }
  }
}

TEST(ChainPlan, OneColumnOfTheRotationMayBeWantedAlone) {
  for (std::uint64_t seed = 450; seed < 470; ++seed) {
    Case c = random_case(seed, 0.4);
    c.errors.composition.first_order = seed % 4 == 0;
    const ChainPlan plan(c.machine, c.errors, Body::tool, Body::workpiece);
    RandomStream random(seed, 3);
    Batch all(c.machine, 37, random);
    all.transform(plan);
    std::vector<const double*> pointers;
    for (const std::vector<double>& v : all.commands) pointers.push_back(v.data());
    const ConstPointArrays start{all.start[0].data(), all.start[1].data(), all.start[2].data()};
    for (std::size_t column = 0; column < 3; ++column) {
      Batch some = all;
      for (std::vector<double>& v : some.rotation) std::fill(v.begin(), v.end(), -1e300);
      RotationArrays wanted;
      for (std::size_t row = 0; row < 3; ++row) wanted.r[3 * row + column] = some.rotation[3 * row + column].data();
      plan.transform({pointers, 37}, start, some.seen_arrays(), wanted);
      for (std::size_t k = 0; k < 37; ++k) {
        for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(some.seen[i][k], all.seen[i][k]);
        for (std::size_t i = 0; i < 9; ++i) {
          if (i % 3 == column) {
            EXPECT_NEAR(some.rotation[i][k], all.rotation[i][k], 4e-15) << "seed " << seed << " element " << i;
          } else {
            EXPECT_EQ(some.rotation[i][k], -1e300);
          }
        }
      }
    }
  }
}

void expect_the_same_for_any_number_of_poses(const Case& c, std::uint64_t seed) {
  const ChainPlan plan(c.machine, c.errors, Body::tool, Body::workpiece);
  RandomStream random(seed);
  Batch all(c.machine, 300, random);
  all.transform(plan);
  for (std::size_t count = 1; count <= 300; count += count < 40 ? 1 : 13) {
    Batch some = all;
    for (std::vector<double>& v : some.seen) std::fill(v.begin(), v.end(), -1e300);
    std::vector<const double*> pointers;
    for (const std::vector<double>& v : some.commands) pointers.push_back(v.data() + (300 - count));
    const ConstPointArrays start{&some.start[0][300 - count], &some.start[1][300 - count], &some.start[2][300 - count]};
    plan.transform({pointers, count}, start, some.seen_arrays(), some.rotation_arrays(), some.covered.data());
    for (std::size_t k = 0; k < count; ++k) {
      for (std::size_t i = 0; i < 3; ++i) ASSERT_EQ(some.seen[i][k], all.seen[i][300 - count + k]) << count;
      for (std::size_t i = 0; i < 9; ++i) ASSERT_EQ(some.rotation[i][k], all.rotation[i][300 - count + k]) << count;
    }
    if (count < 300) {
      EXPECT_EQ(some.seen[0][count], -1e300) << "wrote past the end";
    }
  }
}

TEST(ChainPlan, DoesNotDependOnHowManyPosesAreEvaluatedTogether) {
  for (std::uint64_t seed = 500; seed < 508; ++seed) {
    // Angles around the limits of the short series, so that neighbours take different ways.
    expect_the_same_for_any_number_of_poses(random_case(seed, seed < 504 ? 0.4 : 0.1), seed);
  }
}

TEST(ChainPlan, StartsFromTheToolInTheSameWayForAnyNumberOfPoses) {
  Case c;
  RandomStream random(3);
  for (const char* name : {"X", "Y", "Z"}) {
    const std::size_t axis = c.machine.axes.size();
    c.machine.axes.push_back({name, AxisKind::linear, ChainSide::tool, false, direction_from_letter(name[0])});
    c.machine.axes.back().travel_min = -200;
    c.machine.axes.back().travel_max = 300;
    const Basis basis{.kind = BasisKind::legendre, .order = 2, .from = -200, .to = 300};
    for (int k = 3; k < 6; ++k) {
      // Up to 2 mrad: on both sides of the limit of the short series.
      c.errors.motions.push_back({axis, static_cast<Component>(k), basis, {0, 1e-3, random.uniform(-1e-3, 1e-3)}, {}});
    }
  }
  expect_the_same_for_any_number_of_poses(c, 3);
}

TEST(ChainPlan, AddsAnyNumberOfHarmonics) {
  for (int harmonics = 1; harmonics <= 12; ++harmonics) {
    Case c;
    c.machine.axes.push_back({"X", AxisKind::linear, ChainSide::tool, false, Eigen::Vector3d::UnitX()});
    const Basis basis{.kind = BasisKind::fourier, .order = harmonics, .from = -5, .to = 5, .period = 7};
    RandomStream random(static_cast<std::uint64_t>(harmonics));
    std::vector<double> coefficients(basis.size());
    for (double& value : coefficients) value = random.uniform(-1, 1);
    c.errors.motions.push_back({0, Component::Y, basis, coefficients, {}});
    Batch batch(c.machine, 100, random);
    for (double& value : batch.commands[0]) value = random.uniform(-5, 5);
    batch.transform(ChainPlan(c.machine, c.errors, Body::tool, Body::bed));
    for (std::size_t k = 0; k < batch.count(); ++k) {
      double expected = batch.start[1][k] + coefficients[0];
      for (std::size_t h = 1; 2 * h < coefficients.size(); ++h) {
        const double angle = static_cast<double>(h) * 2 * std::numbers::pi / 7 * batch.commands[0][k];
        expected += coefficients[2 * h - 1] * std::cos(angle) + coefficients[2 * h] * std::sin(angle);
      }
      EXPECT_NEAR(batch.seen[1][k], expected, 2e-13) << harmonics << " harmonics";
    }
  }
}

TEST(ChainPlan, MayWriteTheSeenPointsOverTheStartPoints) {
  const Case c = random_case(600, 0.1);
  const ChainPlan plan(c.machine, c.errors, Body::tool, Body::workpiece);
  RandomStream random(1);
  Batch batch(c.machine, 200, random);
  batch.transform(plan);
  const PointArrays in_place{batch.start[0].data(), batch.start[1].data(), batch.start[2].data()};
  plan.transform(batch.positions(), batch.start_arrays(), in_place);
  EXPECT_EQ(batch.start, batch.seen);
}

TEST(ChainPlan, GivesTheSameResultsToSeveralThreads) {
  const Case c = random_case(601, 0.1);
  const ChainPlan plan(c.machine, c.errors, Body::tool, Body::workpiece);
  RandomStream random(1);
  Batch batch(c.machine, 1000, random), other = batch;
  std::jthread thread([&] { other.transform(plan); });
  batch.transform(plan);
  thread.join();
  EXPECT_EQ(batch.seen, other.seen);
}

TEST(ChainPlan, TakesNewParameterValues) {
  for (std::uint64_t seed = 700; seed < 720; ++seed) {
    Case c = random_case(seed, 0.1);
    ChainPlan plan(c.machine, c.errors, Body::tool, Body::workpiece);
    std::vector<double> values = c.errors.parameters();
    RandomStream random(seed);
    for (double& value : values) value *= random.uniform(-2, 2);
    plan.set_parameters(values);
    c.errors.set_parameters(values);
    Batch batch(c.machine, 30, random), fresh = batch;
    batch.transform(plan);
    fresh.transform(ChainPlan(c.machine, c.errors, Body::tool, Body::workpiece));
    EXPECT_EQ(batch.seen, fresh.seen);
    EXPECT_EQ(batch.rotation, fresh.rotation);
  }
}

TEST(ChainPlan, FlagsWhatErrorMotionsDoNotCover) {
  for (std::uint64_t seed = 800; seed < 830; ++seed) {
    const Case c = random_case(seed, 0.1);
    RandomStream random(seed);
    Batch batch(c.machine, 200, random);
    for (std::vector<double>& axis : batch.commands) {
      for (double& value : axis) value *= 1.2;
    }
    batch.transform(ChainPlan(c.machine, c.errors, Body::tool, Body::workpiece));
    for (std::size_t k = 0; k < batch.count(); ++k) {
      bool covered = true;
      for (std::size_t i = 0; i < c.machine.axes.size(); ++i) covered &= c.errors.covers(i, batch.commands[i][k]);
      EXPECT_EQ(batch.covered[k], covered ? 1 : 0);
    }
  }
}

TEST(ChainPlan, DoesNotCoverACommandThatIsNoNumberOrAbsurd) {
  for (std::uint64_t seed = 900; seed < 920; ++seed) {
    const Case c = random_case(seed, 0.1);
    RandomStream random(seed);
    Batch batch(c.machine, 4, random);
    batch.commands[0][0] = std::numeric_limits<double>::quiet_NaN();
    batch.commands[0][1] = std::numeric_limits<double>::infinity();
    batch.commands[0][2] = -std::numeric_limits<double>::infinity();
    batch.transform(ChainPlan(c.machine, c.errors, Body::tool, Body::workpiece));
    EXPECT_THAT(batch.covered, testing::ElementsAre(0, 0, 0, 1));
  }
}

TEST(ChainPlan, TurnsExactlyThroughThousandsOfRevolutions) {
  Case c;
  c.machine.axes.push_back({"C", AxisKind::rotary, ChainSide::tool, false, Eigen::Vector3d::UnitZ()});
  const ChainPlan plan(c.machine, c.errors, Body::tool, Body::bed);
  RandomStream random(3);
  Batch batch(c.machine, 5000, random);
  for (std::size_t k = 0; k < batch.count(); ++k) {
    batch.commands[0][k] = random.uniform(-2e4, 2e4);
    if (k % 3 == 0) batch.commands[0][k] = std::round(batch.commands[0][k]) * std::numbers::pi / 4;
  }
  batch.transform(plan);
  for (std::size_t k = 0; k < batch.count(); ++k) {
    EXPECT_NEAR(batch.rotation[3][k], std::sin(batch.commands[0][k]), 2e-16);
    EXPECT_NEAR(batch.rotation[0][k], std::cos(batch.commands[0][k]), 2e-16);
  }
}

}  // namespace
}  // namespace abbe
