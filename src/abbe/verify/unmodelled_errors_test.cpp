#include "abbe/verify/unmodelled_errors.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

#include "abbe/errors/random_stream.h"
#include "abbe/geometry/decompositions.h"
#include "abbe/machine/machines_for_test.h"
#include "abbe/verify/error_map.h"

namespace abbe {
namespace {

using Eigen::Index;

PoseList random_poses(const Machine& machine, std::size_t count) {
  PoseList poses;
  for (std::size_t k = 0; k < count; ++k) {
    RandomStream random(15, k);
    std::vector<double> positions;
    for (const Axis& axis : machine.axes) {
      positions.push_back(axis.endless ? random.uniform(0, 6.283) : random.uniform(axis.travel_min, axis.travel_max));
    }
    poses.append(positions);
  }
  return poses;
}

ErrorMotion motion(const Machine& machine, std::size_t axis, Component component, int order) {
  ErrorMotion result{axis, component, {}, {}, {}};
  const Axis& moving = machine.axes[axis];
  result.basis = {BasisKind::legendre, order, moving.travel_min, moving.travel_max};
  if (moving.endless) {
    result.basis = {BasisKind::fourier, order, 0, 6.283185307179586};
    result.basis.period = 6.283185307179586;
  }
  result.coefficients.assign(result.basis.size(), 0.0);
  return result;
}

/// Every error motion of every axis but those named.
ErrorSet all_motions(const Machine& machine, int order, const std::string& but = "") {
  ErrorSet errors;
  for (std::size_t axis = 0; axis < machine.axes.size(); ++axis) {
    for (int c = 0; c < kComponentCount; ++c) {
      const std::string name = error_motion_name(machine, axis, static_cast<Component>(c));
      if (but.find(name) == std::string::npos)
        errors.motions.push_back(motion(machine, axis, static_cast<Component>(c), order));
    }
  }
  return errors;
}

std::string names(const Machine& machine, const std::vector<UnmodelledError>& list) {
  std::string text;
  for (const UnmodelledError& error : list) {
    text += text.empty() ? "" : " ";
    text += error.is_location ? location_error_name(machine, error.axis, error.component)
                              : error_motion_name(machine, error.axis, error.component);
  }
  return text;
}

/// Displacements by one parameter, by differences of the exact model: [3 poses].
Eigen::VectorXd field(const Machine& machine, ErrorSet errors, std::size_t parameter, const PoseSource& poses) {
  ErrorMapOptions options;
  options.orientation = false;
  std::vector<double> values(errors.parameter_count(), 0.0);
  std::array<ErrorMap, 2> maps;
  const double step = 1e-5;
  for (int side = 0; side < 2; ++side) {
    values[parameter] = side == 0 ? step : -step;
    errors.set_parameters(values);
    maps[static_cast<std::size_t>(side)] = error_map(machine, errors, nullptr, poses, options);
  }
  Eigen::VectorXd column(3 * static_cast<Index>(poses.count));
  for (std::size_t k = 0; k < poses.count; ++k) {
    for (std::size_t d = 0; d < 3; ++d) {
      column[static_cast<Index>(3 * k + d)] = (maps[0].displacement[d][k] - maps[1].displacement[d][k]) / (2 * step);
    }
  }
  return column;
}

TEST(UnmodelledErrors, AModelWithAllMotionsLeavesNothingOut) {
  const Machine machine = test::three_axis_mill();
  const PoseList poses = random_poses(machine, 80);
  // The slopes of the straightness motions take the place of the squareness errors.
  EXPECT_EQ(names(machine, unmodelled_errors(machine, all_motions(machine, 2), pose_source(poses))), "");
}

TEST(UnmodelledErrors, WithoutSlopesSquarenessErrorsAreMissing) {
  const Machine machine = test::three_axis_mill();
  const PoseList poses = random_poses(machine, 80);
  ErrorSet constants = all_motions(machine, 0);
  // Constant angles of Y turn X, which stands on it, about Y and Z; nothing turns Z against both about X.
  EXPECT_EQ(names(machine, unmodelled_errors(machine, constants, pose_source(poses))), "EA0Z");
  std::erase_if(constants.motions, [](const ErrorMotion& one) { return is_rotation(one.component); });
  const std::string missing = names(machine, unmodelled_errors(machine, constants, pose_source(poses)));
  EXPECT_NE(missing.find("EA0Z EB0Z EC0Y"), std::string::npos) << missing;
}

TEST(UnmodelledErrors, AModelOfOneMotionNamesTheOthersAndThreeSquarenesses) {
  const Machine machine = test::three_axis_mill();
  const PoseList poses = random_poses(machine, 80);
  ErrorSet model;
  model.motions.push_back(motion(machine, 0, Component::X, 4));
  const std::vector<UnmodelledError> list = unmodelled_errors(machine, model, pose_source(poses));
  std::size_t motions = 0, locations = 0;
  for (const UnmodelledError& error : list) {
    (error.is_location ? locations : motions) += 1;
    EXPECT_GT(error.effect, 0);
  }
  // The functional point stands on the line of Z: its roll moves nothing there.
  EXPECT_EQ(motions, 16U) << names(machine, list);
  EXPECT_EQ(names(machine, list).find("ECZ"), std::string::npos);
  EXPECT_EQ(locations, 3U) << names(machine, list);
}

TEST(UnmodelledErrors, TheEffectIsWhatTheExactModelSaysItIsBesideRigidMotionsAndTheModel) {
  const Machine machine = test::three_axis_mill();
  const PoseList poses = random_poses(machine, 60);
  const PoseSource source = pose_source(poses);
  const ErrorSet model = all_motions(machine, 2, "EBX EXX EC0Y");
  const std::vector<UnmodelledError> list = unmodelled_errors(machine, model, source);
  ASSERT_EQ(names(machine, list), "EXX EBX");
  // A second route: fields by differences of the exact model, least squares of each over rigid motions and the model.
  std::vector<double> from, to;
  for (const std::vector<double>& positions : poses.axis) {
    from.push_back(*std::min_element(positions.begin(), positions.end()));
    to.push_back(*std::max_element(positions.begin(), positions.end()));
  }
  const ErrorSet all = errors_with(machine, model, list, from, to);
  Eigen::MatrixXd known(180, 6 + 3 * static_cast<Index>(model.motions.size()));
  ErrorMapOptions options;
  options.orientation = false;
  const ErrorMap nominal = error_map(machine, ErrorSet{}, nullptr, source, options);
  for (Index k = 0; k < 60; ++k) {
    const std::size_t at = static_cast<std::size_t>(k);
    const double x = nominal.point[0][at], y = nominal.point[1][at], z = nominal.point[2][at];
    known.block<3, 6>(3 * k, 0) << 1, 0, 0, 0, z, -y, 0, 1, 0, -z, 0, x, 0, 0, 1, y, -x, 0;
  }
  for (Index p = 0; p + 6 < known.cols(); ++p)
    known.col(6 + p) = field(machine, all, static_cast<std::size_t>(p), source);
  for (Index p = 0; p < known.cols(); ++p) {
    if (known.col(p).norm() > 0) known.col(p).normalize();
  }
  // Differences of dependent columns leave rounding, which is no direction.
  const CompleteOrthogonal solver(known, 1e-6);
  const std::size_t first = static_cast<std::size_t>(known.cols()) - 6;
  for (std::size_t e = 0; e < 2; ++e) {
    double square = 0;
    for (const std::size_t shape : {2U, 3U}) {
      const Eigen::VectorXd column = field(machine, all, first + 4 * e + shape, source);
      square += (column - known * solver.solve(column)).squaredNorm() / 2 / 60;
    }
    EXPECT_NEAR(list[e].effect, (e == 0 ? 0.01 : 5e-5) * std::sqrt(square), 1e-6 * list[e].effect);
  }
}

TEST(UnmodelledErrors, RotaryAxesLackTheirAxisAverageLine) {
  const Machine machine = test::aguado_table();
  const PoseList poses = random_poses(machine, 120);
  ErrorSet model;  // slopes of the linear axes would take the place of the tilts
  model.motions.push_back(motion(machine, 1, Component::X, 3));
  const std::string list = names(machine, unmodelled_errors(machine, model, pose_source(poses)));
  for (const char* name : {"EXC", "EYC", "EZC", "EAC", "EBC", "ECC"}) EXPECT_NE(list.find(name), std::string::npos);
  // X and Z alone have one squareness; how they stand together is the tilt and the place of the table.
  for (const char* name : {"EB0Z", "EY0C", "EA0C", "EB0C"}) EXPECT_NE(list.find(name), std::string::npos) << list;
  for (const char* name : {"EB0X", "EC0X", "EA0Z"}) EXPECT_EQ(list.find(name), std::string::npos) << list;
  EXPECT_EQ(list.find("EC0C"), std::string::npos) << "a zero position is not an error of the machine: " << list;
}

TEST(UnmodelledErrors, WhatStandsStillIsNotMissed) {
  const Machine machine = test::three_axis_mill();
  PoseList poses = random_poses(machine, 40);
  for (double& position : poses.axis[1]) position = 0;
  const std::vector<UnmodelledError> list =
      unmodelled_errors(machine, all_motions(machine, 2, "EXY EYY EZY EAY EBY ECY"), pose_source(poses));
  EXPECT_EQ(names(machine, list), "");
}

TEST(UnmodelledErrors, TheTruthWithoutThemKeepsEverythingElse) {
  const Machine machine = test::three_axis_mill();
  ErrorSet truth = all_motions(machine, 1);
  truth.locations = {{1, Component::C, 1e-5, 0}, {2, Component::A, 2e-5, 0}};
  const ErrorSet rest = errors_without(truth, {{0, Component::B, false, 0}, {2, Component::A, true, 0}});
  EXPECT_EQ(rest.motions.size(), truth.motions.size() - 1);
  ASSERT_EQ(rest.locations.size(), 1U);
  EXPECT_EQ(rest.locations[0].component, Component::C);
}

TEST(UnmodelledErrors, PosesOfAnotherMachineAreRefused) {
  const PoseList poses = random_poses(test::aguado_table(), 4);
  Machine machine = test::three_axis_mill();
  machine.axes.pop_back();
  machine.axes.pop_back();
  EXPECT_THROW((void)unmodelled_errors(machine, ErrorSet{}, pose_source(poses)), std::invalid_argument);
}

}  // namespace
}  // namespace abbe
