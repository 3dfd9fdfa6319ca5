#include "abbe/compensate/compensated_inverse.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>

#include "abbe/compensate/program/errors_for_test.h"
#include "abbe/errors/actual_pose.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

/// Poses in and out, with memory of their own.
struct Corrections {
  Corrections(const Machine& machine, const std::vector<std::vector<double>>& poses)
      : count(poses.size()), commands(machine.axes.size()), corrected(machine.axes.size()) {
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
      for (const std::vector<double>& pose : poses) commands[i].push_back(pose[i]);
      corrected[i].resize(count);
      in.push_back(commands[i].data());
      out.push_back(corrected[i].data());
    }
    status.resize(count);
    position_residual.resize(count);
    orientation_residual.resize(count);
  }
  void correct(const CompensatedInverse& inverse) { inverse.correct({in, count}, arrays()); }
  CorrectedArrays arrays() { return {out, status.data(), position_residual.data(), orientation_residual.data()}; }
  std::vector<double> command(std::size_t k) const { return at(commands, k); }
  std::vector<double> result(std::size_t k) const { return at(corrected, k); }

  std::size_t count;
  std::vector<std::vector<double>> commands, corrected;
  std::vector<const double*> in;
  std::vector<double*> out;
  std::vector<CorrectionStatus> status;
  std::vector<double> position_residual, orientation_residual;

 private:
  static std::vector<double> at(const std::vector<std::vector<double>>& axes, std::size_t k) {
    std::vector<double> pose;
    for (const std::vector<double>& axis : axes) pose.push_back(axis[k]);
    return pose;
  }
};

std::vector<std::vector<double>> random_poses(const Machine& machine, std::size_t count, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  std::vector<std::vector<double>> poses;
  while (poses.size() < count) poses.push_back(test::inner_commands(machine, generator));
  return poses;
}

double missed_point(const RigidTransform& a, const RigidTransform& b) { return (a.translation - b.translation).norm(); }

double missed_direction(const Machine& machine, const RigidTransform& a, const RigidTransform& b) {
  const Eigen::Vector3d one = a.rotation * machine.tool_direction, other = b.rotation * machine.tool_direction;
  return std::atan2(one.cross(other).norm(), one.dot(other));
}

TEST(CompensatedInverse, BringsTheActualToolToTheNominalPoseOfEveryMachine) {
  for (const test::NamedMachine& named : test::all_machines()) {
    const Machine& machine = named.machine;
    SCOPED_TRACE(named.name);
    const ErrorSet errors = test::tens_of_micrometres(machine, 3);
    Corrections poses(machine, random_poses(machine, 300, 5));
    poses.correct(CompensatedInverse(machine, errors));
    int reached = 0;
    for (std::size_t k = 0; k < poses.count; ++k) {
      const RigidTransform wanted = nominal_workpiece_from_tool(machine, poses.command(k));
      const RigidTransform before = actual_workpiece_from_tool(machine, errors, poses.command(k));
      const RigidTransform after = actual_workpiece_from_tool(machine, errors, poses.result(k));
      EXPECT_GE(missed_point(before, wanted), 1e-3);
      EXPECT_NEAR(poses.position_residual[k], missed_point(after, wanted), 2e-11);
      EXPECT_NEAR(poses.orientation_residual[k], missed_direction(machine, after, wanted), 1e-13);
      if (poses.status[k] == CorrectionStatus::reached) {
        ++reached;
        EXPECT_LE(missed_point(after, wanted), 1.1e-9);
      } else {
        EXPECT_NE(poses.status[k], CorrectionStatus::not_run);
        // With fewer than three axes for the point, the nearest place may lie where the derivative vanishes.
        if (machine.axes.size() >= 3) {
          EXPECT_NE(poses.status[k], CorrectionStatus::not_converged) << k;
        }
        EXPECT_LE(missed_point(after, wanted), missed_point(before, wanted) + 1e-3) << k;
      }
    }
    RecordProperty(named.name, reached);
  }
}

TEST(CompensatedInverse, FiveAxesReachPointAndDirectionAwayFromSingularities) {
  const Machine machine = test::trunnion_mill();
  const ErrorSet errors = test::tens_of_micrometres(machine, 7);
  std::vector<std::vector<double>> list = random_poses(machine, 2000, 11);
  const std::size_t a = machine.find_axis("A");
  for (std::vector<double>& pose : list) {
    if (std::abs(pose[a]) < 5 * kDegree) pose[a] += 10 * kDegree;
  }
  Corrections poses(machine, list);
  poses.correct(CompensatedInverse(machine, errors));
  for (std::size_t k = 0; k < poses.count; ++k) {
    ASSERT_EQ(poses.status[k], CorrectionStatus::reached) << k;
    const RigidTransform wanted = nominal_workpiece_from_tool(machine, poses.command(k));
    const RigidTransform after = actual_workpiece_from_tool(machine, errors, poses.result(k));
    EXPECT_LE(missed_point(after, wanted), 1.1e-9);
    EXPECT_LE(missed_direction(machine, after, wanted), 1.1e-11);
  }
}

TEST(CompensatedInverse, WithoutErrorsCommandsStayAsTheyAre) {
  for (const test::NamedMachine& named : test::all_machines()) {
    SCOPED_TRACE(named.name);
    Corrections poses(named.machine, random_poses(named.machine, 50, 2));
    poses.correct(CompensatedInverse(named.machine, {}));
    for (std::size_t k = 0; k < poses.count; ++k) {
      EXPECT_EQ(poses.status[k], CorrectionStatus::reached);
      EXPECT_EQ(poses.result(k), poses.command(k));
    }
  }
}

TEST(CompensatedInverse, NearASingularityTheTurnIsBoundedAndThePointReached) {
  const Machine machine = test::trunnion_mill();
  const ErrorSet errors = test::tens_of_micrometres(machine, 13);
  const std::size_t a = machine.find_axis("A"), c = machine.find_axis("C");
  std::vector<double> pose(machine.axes.size(), 0.0);
  for (std::size_t i = 0; i < pose.size(); ++i) {
    if (!machine.axes[i].endless) pose[i] = 0.5 * (machine.axes[i].travel_min + machine.axes[i].travel_max);
  }
  pose[c] = 0.3;
  pose[a] = 0.004;  // C and the tool nearly parallel
  CorrectionOptions options;
  options.largest_turn = 0.004;
  Corrections poses(machine, {pose});
  poses.correct(CompensatedInverse(machine, errors, options));
  EXPECT_EQ(poses.status[0], CorrectionStatus::turn_limited);
  const std::vector<double> result = poses.result(0);
  EXPECT_LE(std::hypot(result[a] - pose[a], result[c] - pose[c]), options.largest_turn);
  const RigidTransform wanted = nominal_workpiece_from_tool(machine, pose);
  EXPECT_LE(missed_point(actual_workpiece_from_tool(machine, errors, result), wanted), 1.1e-9);
  const double left = missed_direction(machine, actual_workpiece_from_tool(machine, errors, result), wanted);
  EXPECT_GT(left, 1e-9);
  const double before = missed_direction(machine, actual_workpiece_from_tool(machine, errors, pose), wanted);
  EXPECT_LT(left, before);
  // No other turn of that size leaves much less.
  for (int i = 0; i < 400; ++i) {
    const double angle = 2 * std::numbers::pi * i / 400;
    for (const double part : {0.25, 0.5, 0.75, 1.0}) {
      std::vector<double> other = pose;
      other[a] += part * options.largest_turn * std::cos(angle);
      other[c] += part * options.largest_turn * std::sin(angle);
      EXPECT_GE(missed_direction(machine, actual_workpiece_from_tool(machine, errors, other), wanted),
                left - 0.39 * before);
    }
  }
}

TEST(CompensatedInverse, ThroughASingularityNoCommandJumps) {
  const Machine machine = test::trunnion_mill();
  const ErrorSet errors = test::tens_of_micrometres(machine, 17);
  const std::size_t a = machine.find_axis("A"), c = machine.find_axis("C");
  std::vector<std::vector<double>> list;
  constexpr int kHalf = 20000;
  for (int i = -kHalf; i <= kHalf; ++i) {
    std::vector<double> pose(machine.axes.size(), 0.0);
    for (std::size_t k = 0; k < pose.size(); ++k) {
      if (!machine.axes[k].endless) pose[k] = 0.5 * (machine.axes[k].travel_min + machine.axes[k].travel_max);
    }
    pose[c] = 0.3;
    pose[a] = 1e-6 * i;
    list.push_back(pose);
  }
  Corrections poses(machine, list);
  poses.correct(CompensatedInverse(machine, errors));
  double largest = 0;
  for (std::size_t k = 1; k < poses.count; ++k) {
    EXPECT_NE(poses.status[k], CorrectionStatus::not_converged);
    EXPECT_LE(std::abs(poses.corrected[c][k] - list[k][c]), 0.01 + 1e-9);
    largest = std::max(largest, std::abs(poses.corrected[c][k] - poses.corrected[c][k - 1]));
  }
  // A goes on in steps of 1e-6 rad; C turns no more than a few times as fast.
  EXPECT_LE(largest, 5e-6);
}

TEST(CompensatedInverse, AResultDoesNotDependOnThePosesWithIt) {
  const Machine machine = test::gantry_fork_head();
  const CompensatedInverse inverse(machine, test::tens_of_micrometres(machine, 19));
  const std::vector<std::vector<double>> list = random_poses(machine, 300, 23);
  Corrections all(machine, list);
  all.correct(inverse);
  for (std::size_t k = 0; k < list.size(); k += 7) {
    Corrections one(machine, {list[k]});
    one.correct(inverse);
    EXPECT_EQ(one.result(0), all.result(k));
    EXPECT_EQ(one.status[0], all.status[k]);
  }
}

TEST(CompensatedInverse, InPlaceItDoesTheSame) {
  const Machine machine = test::trunnion_mill();
  const CompensatedInverse inverse(machine, test::tens_of_micrometres(machine, 29));
  Corrections poses(machine, random_poses(machine, 200, 31));
  poses.correct(inverse);
  std::vector<std::vector<double>> axes = poses.commands;
  std::vector<double*> in_place;
  for (std::vector<double>& axis : axes) in_place.push_back(axis.data());
  const std::vector<const double*> in(in_place.begin(), in_place.end());
  inverse.correct({in, poses.count}, {in_place, nullptr, nullptr, nullptr});
  EXPECT_EQ(axes, poses.corrected);
}

TEST(CompensatedInverse, TravelIsKeptAndSaid) {
  const Machine machine = test::three_axis_mill();
  ErrorSet errors;
  const Basis constant{.kind = BasisKind::legendre, .order = 0, .from = -1e4, .to = 1e4};
  const std::size_t x = machine.find_axis("X");
  errors.motions.push_back({x, Component::X, constant, {-0.05}, {}});
  std::vector<double> pose;
  for (const Axis& axis : machine.axes) pose.push_back(0.5 * (axis.travel_min + axis.travel_max));
  pose[x] = machine.axes[x].sense() > 0 ? machine.axes[x].travel_max : machine.axes[x].travel_min;
  Corrections poses(machine, {pose});
  poses.correct(CompensatedInverse(machine, errors));
  EXPECT_EQ(poses.status[0], CorrectionStatus::outside_travel);
  EXPECT_EQ(poses.result(0)[x], pose[x]);
  EXPECT_NEAR(poses.position_residual[0], 0.05, 1e-9);
}

TEST(CompensatedInverse, WhereARotaryAxisIsAtItsEndThePointIsStillReached) {
  const Machine machine = test::trunnion_mill();
  const ErrorSet errors = test::tens_of_micrometres(machine, 53);
  const std::size_t a = machine.find_axis("A"), c = machine.find_axis("C");
  std::vector<std::vector<double>> list = random_poses(machine, 400, 59);
  for (std::size_t k = 0; k < list.size(); ++k) {
    list[k][a] = k % 2 == 0 ? machine.axes[a].travel_min : machine.axes[a].travel_max;
  }
  Corrections poses(machine, list);
  poses.correct(CompensatedInverse(machine, errors));
  int at_end = 0;
  for (std::size_t k = 0; k < poses.count; ++k) {
    const RigidTransform wanted = nominal_workpiece_from_tool(machine, poses.command(k));
    const RigidTransform after = actual_workpiece_from_tool(machine, errors, poses.result(k));
    EXPECT_GE(poses.result(k)[a], machine.axes[a].travel_min);
    EXPECT_LE(poses.result(k)[a], machine.axes[a].travel_max);
    EXPECT_LE(missed_point(after, wanted), 1.1e-9) << k;
    EXPECT_NEAR(poses.orientation_residual[k], missed_direction(machine, after, wanted), 1e-13);
    if (poses.status[k] != CorrectionStatus::outside_travel) continue;
    ++at_end;
    EXPECT_EQ(poses.result(k)[a], list[k][a]);
    // No turn of C leaves less of the orientation.
    for (const double turn : {-1e-5, 1e-5}) {
      std::vector<double> other = poses.result(k);
      other[c] += turn;
      const RigidTransform there = actual_workpiece_from_tool(machine, errors, other);
      EXPECT_GE(missed_direction(machine, there, wanted), poses.orientation_residual[k]) << k;
    }
  }
  EXPECT_GE(at_end, 100);
  EXPECT_LE(at_end, 300);
}

TEST(CompensatedInverse, WhereALinearAxisIsAtItsEndTheOthersAreCorrected) {
  const Machine machine = test::trunnion_mill();
  const ErrorSet errors = test::tens_of_micrometres(machine, 61);
  const std::size_t a = machine.find_axis("A"), x = machine.find_axis("X");
  std::vector<std::vector<double>> list = random_poses(machine, 200, 67);
  for (std::vector<double>& pose : list) {
    pose[x] = machine.axes[x].travel_max;
    if (std::abs(pose[a]) < 5 * kDegree) pose[a] += 10 * kDegree;
  }
  Corrections poses(machine, list);
  poses.correct(CompensatedInverse(machine, errors));
  int at_end = 0;
  for (std::size_t k = 0; k < poses.count; ++k) {
    if (poses.status[k] != CorrectionStatus::outside_travel) continue;
    ++at_end;
    const RigidTransform wanted = nominal_workpiece_from_tool(machine, poses.command(k));
    const RigidTransform after = actual_workpiece_from_tool(machine, errors, poses.result(k));
    EXPECT_EQ(poses.result(k)[x], list[k][x]);
    EXPECT_LE(missed_direction(machine, after, wanted), 1.1e-11);
    EXPECT_NEAR(poses.position_residual[k], missed_point(after, wanted), 1e-11);
    // The other linear axes have nothing to gain.
    const Eigen::Vector3d missing = wanted.translation - after.translation;
    for (const char* const name : {"Y", "Z"}) {
      std::vector<double> beyond = poses.result(k);
      beyond[machine.find_axis(name)] += 0.01;
      const Eigen::Vector3d along =
          (actual_workpiece_from_tool(machine, errors, beyond).translation - after.translation).normalized();
      EXPECT_LE(std::abs(missing.dot(along)), 1e-6 * missing.norm() + 2e-9) << k;
    }
  }
  EXPECT_GE(at_end, 40);
}

TEST(CompensatedInverse, TooFewIterationsAreTheSameBesidePosesAtTheEndOfATravel) {
  const Machine machine = test::trunnion_mill();
  Machine wide = machine;
  const std::size_t a = machine.find_axis("A");
  wide.axes[a].travel_min -= 1;
  wide.axes[a].travel_max += 1;
  const ErrorSet errors = test::tens_of_micrometres(machine, 71);
  std::vector<std::vector<double>> list = random_poses(machine, 200, 73);
  for (std::size_t k = 0; k < list.size(); k += 2) list[k][a] = machine.axes[a].travel_max;
  int not_converged = 0, at_end = 0;
  for (int iterations = 2; iterations <= 8; ++iterations) {
    SCOPED_TRACE(iterations);
    CorrectionOptions options;
    options.largest_iterations = iterations;
    const CompensatedInverse inverse(machine, errors, options);
    Corrections poses(machine, list), free(wide, list);
    poses.correct(inverse);
    free.correct(CompensatedInverse(wide, errors, options));
    for (std::size_t k = 0; k < poses.count; ++k) {
      const std::vector<double> found = poses.result(k);
      EXPECT_LE(found[a], machine.axes[a].travel_max) << k;
      const bool ended = poses.status[k] != CorrectionStatus::not_converged;
      EXPECT_EQ(ended, free.status[k] != CorrectionStatus::not_converged) << k;
      if (!ended) {
        EXPECT_EQ(found, list[k]);
        ++not_converged;
      }
      at_end += poses.status[k] == CorrectionStatus::outside_travel ? 1 : 0;
      const RigidTransform wanted = nominal_workpiece_from_tool(machine, list[k]);
      const RigidTransform after = actual_workpiece_from_tool(machine, errors, found);
      EXPECT_NEAR(poses.position_residual[k], missed_point(after, wanted), 2e-11) << k;
      Corrections alone(machine, {list[k]});
      alone.correct(inverse);
      EXPECT_EQ(alone.status[0], poses.status[k]) << k;
      EXPECT_EQ(alone.result(0), found) << k;
    }
  }
  EXPECT_GE(not_converged, 100);
  EXPECT_GE(at_end, 100);
}

TEST(CompensatedInverse, WhatIsNotKnownIsLeftAlone) {
  const Machine machine = test::three_axis_mill();
  ErrorSet errors;
  const Basis part{.kind = BasisKind::legendre, .order = 1, .from = 10, .to = 20};
  errors.motions.push_back({machine.find_axis("X"), Component::Y, part, {0.01, 0.02}, {}});
  std::vector<double> known(machine.axes.size(), 15.0), unknown = known, nothing = known;
  unknown[machine.find_axis("X")] = 25;
  nothing[machine.find_axis("Z")] = std::nan("");
  Corrections poses(machine, {known, unknown, nothing});
  poses.correct(CompensatedInverse(machine, errors));
  EXPECT_EQ(poses.status[1], CorrectionStatus::not_covered);
  EXPECT_EQ(poses.result(1), unknown);
  EXPECT_TRUE(std::isnan(poses.position_residual[1]));
  EXPECT_EQ(poses.status[2], CorrectionStatus::not_finite);
  EXPECT_EQ(poses.result(2)[0], nothing[0]);
}

TEST(CompensatedInverse, GivenPosesAreReachedInFullOrientationWhereTheMachineCan) {
  const Machine machine = test::three_axis_head();
  const ErrorSet errors = test::tens_of_micrometres(machine, 37);
  Corrections poses(machine, random_poses(machine, 200, 41));
  // Targets that the actual machine has at other commands near by: they can be reached exactly.
  std::mt19937_64 generator(43);
  std::normal_distribution<double> normal;
  std::vector<std::vector<double>> target(12, std::vector<double>(poses.count));
  for (std::size_t k = 0; k < poses.count; ++k) {
    std::vector<double> near = poses.command(k);
    for (double& command : near) command += 1e-3 * normal(generator);
    const RigidTransform pose = actual_workpiece_from_tool(machine, errors, near);
    for (std::size_t i = 0; i < 3; ++i) target[i][k] = pose.translation[static_cast<Eigen::Index>(i)];
    for (std::size_t i = 0; i < 9; ++i)
      target[3 + i][k] = pose.rotation(static_cast<Eigen::Index>(i / 3), static_cast<Eigen::Index>(i % 3));
  }
  TargetArrays targets{{target[0].data(), target[1].data(), target[2].data()}, {}, {}};
  for (std::size_t i = 0; i < 9; ++i) targets.rotation[i] = target[3 + i].data();
  CorrectionOptions options;
  options.target = TargetKind::full_pose;
  options.largest_turn = 0.5;
  CompensatedInverse(machine, errors, options).reach({poses.in, poses.count}, targets, poses.arrays());
  int reached = 0;
  for (std::size_t k = 0; k < poses.count; ++k) {
    if (poses.status[k] != CorrectionStatus::reached) continue;
    ++reached;
    const RigidTransform after = actual_workpiece_from_tool(machine, errors, poses.result(k));
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_NEAR(after.translation[static_cast<Eigen::Index>(i)], target[i][k], 1.1e-9);
    for (std::size_t i = 0; i < 9; ++i)
      EXPECT_NEAR(after.rotation(static_cast<Eigen::Index>(i / 3), static_cast<Eigen::Index>(i % 3)), target[3 + i][k],
                  2e-11);
  }
  EXPECT_GE(reached, 190);
}

TEST(CompensatedInverse, AnOppositeDirectionIsNotTakenForTheWantedOne) {
  const Machine machine = test::trunnion_mill();
  std::vector<double> pose(machine.axes.size(), 0.0);
  pose[machine.find_axis("A")] = 0.5;
  Corrections poses(machine, {pose});
  const RigidTransform there = nominal_workpiece_from_tool(machine, pose);
  const Eigen::Vector3d opposite = -(there.rotation * machine.tool_direction);
  const TargetArrays targets{{&there.translation[0], &there.translation[1], &there.translation[2]},
                             {&opposite[0], &opposite[1], &opposite[2]},
                             {}};
  CompensatedInverse(machine, {}).reach({poses.in, poses.count}, targets, poses.arrays());
  EXPECT_NE(poses.status[0], CorrectionStatus::reached);
  EXPECT_GT(poses.orientation_residual[0], std::numbers::pi - 0.1);
}

TEST(CompensatedInverse, AnUnsoundMachineIsSaidToBe) {
  Machine machine = test::three_axis_mill();
  machine.axes[0].direction = {0, 0, 2};
  const CompensatedInverse inverse(machine, {});
  EXPECT_FALSE(inverse.problem().empty());
  Corrections poses(machine, {std::vector<double>(machine.axes.size(), 1.0)});
  poses.correct(inverse);
  EXPECT_EQ(poses.status[0], CorrectionStatus::not_run);
}

}  // namespace
}  // namespace abbe
