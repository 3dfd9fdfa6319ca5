#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "abbe/geometry/surface/smooth_surface.h"
#include "abbe/geometry/surface/triangle_mesh.h"
#include "abbe/machine/machine.h"
#include "abbe/plan/scans/scan_plan.h"

namespace abbe {

/// How a face of a part is scanned.
struct ScanFace {
  ScanPathKind kind = ScanPathKind::free;
  std::string why;                                          ///< in words
  Eigen::Vector3d planes = Eigen::Vector3d::UnitZ();        ///< unit, across the planes in which the lines lie
  Eigen::Vector3d mean_normal = Eigen::Vector3d::UnitZ();   ///< raster: the beam
  Eigen::Matrix3d beam_turn = Eigen::Matrix3d::Identity();  ///< rotary: beam = beam_turn * normal
  bool is_revolution = false;
  Eigen::Vector3d axis_point = Eigen::Vector3d::Zero();  ///< mm, of the line about which the face was turned, if it was
  std::size_t turning_axis = Machine::npos;              ///< rotary
  double axis_tilt = 0;                                  ///< rad
  std::vector<double> turning_positions;  ///< rotary: rad, commands of the rotary axes between workpiece and that axis

  /// The beam that is tried first, unit, from the part to the probe.
  Eigen::Vector3d beam(const Eigen::Vector3d& normal) const;
  /// Normal of the surface of which the face's triangles are chords: in a plane with the axis, if it was turned.
  Eigen::Vector3d exact_normal(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) const;
};

/// @param mesh       workpiece frame, mm
/// @param triangles  of the face
ScanFace scan_face(const Machine& machine, const TriangleMesh& mesh, std::span<const std::uint32_t> triangles,
                   double largest_angle);

}  // namespace abbe
