#include <Eigen/Geometry>
#include <cmath>

#include "abbe/formats/robot/robot_program.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/geometry/rotation.h"

namespace abbe {
namespace {

constexpr double kMetre = 1e3;         // mm
constexpr double kNoTurnAbout = 1e-9;  // cosine of the middle angle below which only the sum of the others counts

/// The angle plus the whole turns that bring it nearest to another one.
double nearest_turn(double angle, double to) { return to + std::remainder(angle - to, kTurn); }

/// (x, y, z) with rotation = Rz(z) Ry(y) Rx(x), nearest to `near`; rad.
Eigen::Vector3d nearest_angles(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& near) {
  const double across = std::hypot(rotation(2, 1), rotation(2, 2));
  const auto with_first = [&](double x, double y) {
    // rotation Rx(x)' = Rz(z) Ry(y), whose second column is (-sin z, cos z, 0).
    const Eigen::Vector3d column = std::cos(x) * rotation.col(1) - std::sin(x) * rotation.col(2);
    return Eigen::Vector3d(nearest_turn(x, near[0]), nearest_turn(y, near[1]),
                           nearest_turn(std::atan2(-column[0], column[1]), near[2]));
  };
  const double y = std::atan2(-rotation(2, 0), across);
  if (across < kNoTurnAbout) return with_first(near[0], y);
  const double x = std::atan2(rotation(2, 1), rotation(2, 2));
  const Eigen::Vector3d first = with_first(x, y), second = with_first(x + kTurn / 2, kTurn / 2 - y);
  return (first - near).norm() <= (second - near).norm() ? first : second;
}

/// The rotation vector nearest to `near`: all with whole turns more or less about the same line are the same rotation.
Eigen::Vector3d nearest_vector(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& near) {
  const Eigen::Vector3d vector = rotation_vector(rotation);
  const double angle = vector.norm();
  if (angle < 1e-12) {
    // Any line serves for whole turns.
    const double turns = std::round(near.norm() / kTurn);
    return turns > 0 ? Eigen::Vector3d(near.normalized() * turns * kTurn) : vector;
  }
  const Eigen::Vector3d line = vector / angle;
  return line * (angle + kTurn * std::round((near.dot(line) - angle) / kTurn));
}

/// Angles about x, y, z of KUKA (C, B, A) and Fanuc (W, P, R) in the order of the file.
std::array<std::size_t, 3> angle_order(RobotLanguage language) {
  return language == RobotLanguage::krl ? std::array<std::size_t, 3>{5, 4, 3} : std::array<std::size_t, 3>{3, 4, 5};
}

}  // namespace

RigidTransform robot_pose(const RobotProgram& program, const RobotPosition& position) {
  const auto at = [&](std::size_t i) { return position.pose[i].value; };
  RigidTransform pose;
  pose.translation = {at(0), at(1), at(2)};
  switch (program.language) {
    case RobotLanguage::rapid: {
      const Eigen::Quaterniond q(at(3), at(4), at(5), at(6));
      if (!(q.norm() > 1e-6)) {
        throw InputError({program.file, position.line, 0, position.name + ".rot"}, "the quaternion has no length",
                         "the length 1");
      }
      pose.rotation = q.normalized().toRotationMatrix();
      break;
    }
    case RobotLanguage::krl:
    case RobotLanguage::fanuc_ls: {
      const auto order = angle_order(program.language);
      pose.rotation =
          rotation_from_error_angles({at(order[0]) * kDegree, at(order[1]) * kDegree, at(order[2]) * kDegree});
      break;
    }
    case RobotLanguage::urscript:
      pose.translation *= kMetre;
      pose.rotation = rotation_from_vector({at(3), at(4), at(5)});
      break;
  }
  return pose;
}

std::vector<double> robot_pose_numbers(RobotLanguage language, const RobotPosition& position,
                                       const RigidTransform& workpiece_from_tool) {
  const auto at = [&](std::size_t i) { return position.pose[i].value; };
  std::vector<double> numbers(position.pose.size());
  const double unit = language == RobotLanguage::urscript ? kMetre : 1;
  for (std::size_t i = 0; i < 3; ++i) numbers[i] = workpiece_from_tool.translation[static_cast<Eigen::Index>(i)] / unit;
  switch (language) {
    case RobotLanguage::rapid: {
      Eigen::Quaterniond q(workpiece_from_tool.rotation);
      if (q.dot(Eigen::Quaterniond(at(3), at(4), at(5), at(6))) < 0) q.coeffs() = -q.coeffs();
      numbers[3] = q.w();
      numbers[4] = q.x();
      numbers[5] = q.y();
      numbers[6] = q.z();
      break;
    }
    case RobotLanguage::krl:
    case RobotLanguage::fanuc_ls: {
      const auto order = angle_order(language);
      const Eigen::Vector3d near(at(order[0]), at(order[1]), at(order[2]));
      const Eigen::Vector3d angles = nearest_angles(workpiece_from_tool.rotation, near * kDegree) / kDegree;
      for (std::size_t i = 0; i < 3; ++i) numbers[order[i]] = angles[static_cast<Eigen::Index>(i)];
      break;
    }
    case RobotLanguage::urscript: {
      const Eigen::Vector3d vector = nearest_vector(workpiece_from_tool.rotation, {at(3), at(4), at(5)});
      for (std::size_t i = 0; i < 3; ++i) numbers[3 + i] = vector[static_cast<Eigen::Index>(i)];
      break;
    }
  }
  return numbers;
}

}  // namespace abbe
