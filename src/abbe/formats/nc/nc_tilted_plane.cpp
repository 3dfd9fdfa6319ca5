#include "abbe/formats/nc/nc_tilted_plane.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

namespace abbe {
namespace {

/// Over which the map of a plane to the axes is taken: rounding falls with it.
constexpr double kSpan_mm = 1000;
/// An arc is in a plane of the axes if the normal is that of one, rad.
constexpr double kSameNormal = 1e-9;

NcAxisValues with_xyz(const NcAxisValues& words, const Eigen::Vector3d& xyz) {
  NcAxisValues result = words;
  for (Eigen::Index k = 0; k < 3; ++k) result[static_cast<std::size_t>(k)] = xyz[k];
  return result;
}

}  // namespace

NcTiltedPlane::NcTiltedPlane(const Eigen::Vector3d& origin, const std::array<double, 3>& angles) : origin_(origin) {
  using Eigen::AngleAxisd;
  using Eigen::Vector3d;
  rotation_ = (AngleAxisd(angles[0], Vector3d::UnitZ()) * AngleAxisd(angles[1], Vector3d::UnitX()) *
               AngleAxisd(angles[2], Vector3d::UnitZ()))
                  .toRotationMatrix();
}

void NcTiltedPlane::map(const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& axes_at) {
  at_zero_ = axes_at(Eigen::Vector3d::Zero());
  for (Eigen::Index k = 0; k < 3; ++k) {
    axes_from_plane_.col(k) = (axes_at(kSpan_mm * Eigen::Vector3d::Unit(k)) - at_zero_) / kSpan_mm;
  }
}

NcAxisValues NcTiltedPlane::axes(const NcAxisValues& in_plane) const {
  const Eigen::Vector3d axes = axes_from_plane_ * Eigen::Vector3d(in_plane[0], in_plane[1], in_plane[2]) + at_zero_;
  return with_xyz(in_plane, axes);
}

NcAxisValues NcTiltedPlane::in_plane(const NcAxisValues& axes) const {
  const Eigen::Vector3d stands(axes[0], axes[1], axes[2]);
  const Eigen::Vector3d in_plane = axes_from_plane_.inverse() * (stands - at_zero_);
  return with_xyz(axes, in_plane);
}

bool NcTiltedPlane::keeps_arcs() const {
  return !((axes_from_plane_.transpose() * axes_from_plane_ - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() >
           kSameNormal);
}

void NcTiltedPlane::turn_arc(const NcAxisValues& start, ProgramMove& move) const {
  // Its normal, and the centre with the start's coordinate along it.
  const std::size_t normal = move.plane == ArcPlane::XY ? 2 : move.plane == ArcPlane::ZX ? 1 : 0;
  NcAxisValues centre = start;
  for (std::size_t k = 0; k < 3; ++k) {
    if (k != normal) centre[k] = move.arc_centre[k];
  }
  centre = axes(centre);
  for (std::size_t k = 0; k < 3; ++k) move.arc_centre[k] = centre[k];
  // Seen from the other side where the words are left-handed.
  bool other_side = axes_from_plane_.determinant() < 0;
  const Eigen::Vector3d turned = axes_from_plane_.col(static_cast<Eigen::Index>(normal)).normalized();
  Eigen::Index along = 0;
  const double largest = turned.cwiseAbs().maxCoeff(&along);
  if ((turned.cwiseAbs() - largest * Eigen::Vector3d::Unit(along)).cwiseAbs().maxCoeff() > kSameNormal) {
    move.plane = ArcPlane::tilted;
    move.arc_normal = {turned[0], turned[1], turned[2]};
  } else {
    move.plane = along == 2 ? ArcPlane::XY : along == 1 ? ArcPlane::ZX : ArcPlane::YZ;
    // And where the normal points against the axis.
    other_side = other_side != (turned[along] < 0);
  }
  if (other_side) {
    move.kind = move.kind == MoveKind::arc_clockwise ? MoveKind::arc_counterclockwise : MoveKind::arc_clockwise;
  }
}

}  // namespace abbe
