#pragma once

#include <Eigen/Core>
#include <vector>

#include "abbe/errors/random_stream.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/geometry/rigid_transform.h"
#include "abbe/geometry/surface/ray_tracer.h"

namespace abbe {

/// Whether an eye (a source of light or a camera) sees a point of a surface: nothing is between them, and the line of
/// sight is no flatter on the surface than allowed.
///
/// @param surface        all that may hide the point, the surface itself included
/// @param point, normal  on the surface, mm; unit normal out of the material
/// @param largest_angle  rad, between the normal and the line of sight
bool seen_from(const RayTracer& surface, const Eigen::Vector3d& point, const Eigen::Vector3d& normal,
               const Eigen::Vector3d& eye, double largest_angle);

/// A laser line scanner: a fan of light in a plane, a camera beside that plane.
///
/// Its frame: origin in the middle of the range, the fan in the plane y = 0, z from the part towards the scanner.
struct LineScanner {
  Eigen::Vector3d laser = {0, 0, 57.5};  ///< mm, where the fan comes from
  Eigen::Vector3d camera = {0, 30, 49};  ///< mm, centre of projection
  double width = 1.3;                    ///< mm, of the fan at z = 0
  int points = 1280;                     ///< rays over the width
  double range = 8;                      ///< mm, of z, half of it to either side of 0
  double largest_angle = 85 * kDegree;   ///< rad, of light or view against the normal
  double height_noise = 0;               ///< mm, standard deviation of z of a point
  double across_noise = 0;               ///< mm, of x
  /// Largest systematic deviation of z, mm; one slow wave over the range, whose phase is drawn for each section.
  double linearity = 0;

  /// Table A3 of Yin et al., Machines 9 (2021) 237: 1280 points over 1.3 mm, 0.17 % of 8 mm as the linearity. The noise
  /// of a point, which the table does not state, is 2 um in z and 1 um, one ray, in x.
  static LineScanner published();
};

/// What a line scanner has of one section.
struct ScannedSection {
  Eigen::Matrix2Xd points;   ///< [2, n] x and z in the scanner's frame, mm, in the order of the rays
  std::size_t missed = 0;    ///< rays that meet nothing within the range
  std::size_t too_flat = 0;  ///< rays that meet the surface at too flat an angle to light it
  std::size_t hidden = 0;    ///< points in the light that the camera does not see
};

/// Section of a part: rays of the fan meet it first where they light it; the camera has to see the place.
ScannedSection scan_section(const LineScanner& scanner, const RayTracer& part, const RigidTransform& part_from_scanner,
                            RandomStream& random);

/// A structured-light scanner: a projector lights an area, a camera looks at it.
///
/// Its frame: origin midway between projector and camera, x from the projector to the camera, z towards the scene.
struct AreaScanner {
  double baseline = 240;                ///< mm, between projector and camera
  double largest_angle = 70 * kDegree;  ///< rad, of light or view against the normal
  double noise = 0;                     ///< mm, standard deviation of each coordinate of a point

  Eigen::Vector3d projector() const { return {-baseline / 2, 0, 0}; }
  Eigen::Vector3d camera() const { return {baseline / 2, 0, 0}; }

  /// A place is measured if both projector and camera see it.
  /// @param scene          all that stands there, in a frame of its own
  /// @param point, normal  in the frame of the scene
  bool sees(const RayTracer& scene, const RigidTransform& scene_from_scanner, const Eigen::Vector3d& point,
            const Eigen::Vector3d& normal) const;
};

/// Points of those places that the scanner sees, in its frame, with noise.
/// @param places, normals  [3, n] frame of the scene
/// @param seen             null or filled: indices of the places
Eigen::Matrix3Xd scan_places(const AreaScanner& scanner, const RayTracer& scene,
                             const RigidTransform& scene_from_scanner, const Eigen::Matrix3Xd& places,
                             const Eigen::Matrix3Xd& normals, RandomStream& random,
                             std::vector<Eigen::Index>* seen = nullptr);

}  // namespace abbe
