#pragma once

// Internal to formats: tilted planes of an NC program (G68.2).
#include <Eigen/Core>
#include <array>
#include <functional>

#include "abbe/compensate/program/program_move.h"
#include "abbe/formats/nc/nc_units.h"

namespace abbe {

/// A plane in which X, Y, Z of a program count, and the map of its places to the axes X, Y, Z.
///
/// Place in the workpiece = origin + rotation * X, Y, Z of the plane, each in the directions of X, Y, Z words.
class NcTiltedPlane {
 public:
  /// @param angles  Euler angles, rad: about Z, then about X as it is then, then about Z as it is then
  NcTiltedPlane(const Eigen::Vector3d& origin, const std::array<double, 3>& angles);

  /// mm, in the directions of X, Y, Z words
  Eigen::Vector3d place(const Eigen::Vector3d& in_plane) const { return origin_ + rotation_ * in_plane; }
  Eigen::Vector3d normal() const { return rotation_.col(2); }

  /// Takes the map to the axes, which holds as long as the others stand where they are.
  /// @param axes_at  positions of the axes X, Y, Z at a place in the plane, mm; linear in it
  void map(const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& axes_at);

  /// The same words with X, Y, Z of the axes, or of the plane. As mapped last.
  NcAxisValues axes(const NcAxisValues& in_plane) const;
  NcAxisValues in_plane(const NcAxisValues& axes) const;

  /// Whether an arc in the plane is one in the axes too: their X, Y and Z are at right angles.
  bool keeps_arcs() const;
  /// Turns plane, centre and direction of an arc in the plane to the axes.
  /// @param start  of the arc, words of the plane
  void turn_arc(const NcAxisValues& start, ProgramMove& move) const;

 private:
  Eigen::Vector3d origin_;
  Eigen::Matrix3d rotation_;
  /// Positions of the axes X, Y, Z = axes_from_plane_ * (X, Y, Z of the plane) + at_zero_, mm.
  Eigen::Matrix3d axes_from_plane_ = Eigen::Matrix3d::Identity();
  Eigen::Vector3d at_zero_ = Eigen::Vector3d::Zero();
};

}  // namespace abbe
