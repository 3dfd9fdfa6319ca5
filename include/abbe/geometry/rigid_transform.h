#pragma once

// Where a part stands that was probed at three balls:
//
//   #include <abbe/geometry/best_fit_transform.h>
//   #include <abbe/geometry/rigid_transform.h>
//   #include <abbe/geometry/rotation.h>
//
//   #include <cstdio>
//   #include <vector>
//
//   int main() {
//     const std::vector<Eigen::Vector3d> drawn{{0, 0, 0}, {200, 0, 0}, {0, 150, 0}};  // mm, in the frame of the part
//     const std::vector<Eigen::Vector3d> probed{{120, 80, 50}, {320, 80.2, 50.01}, {119.854, 230, 50}};
//     const abbe::BestFitTransform fit = abbe::best_fit_transform(drawn, probed);
//     if (fit.status != abbe::BestFitStatus::ok) return 1;
//
//     const abbe::RigidTransform machine_from_part = fit.target_from_source;
//     const Eigen::Vector3d bore = machine_from_part * Eigen::Vector3d(100, 75, 20);
//     const Eigen::Vector3d turn_mrad = 1e3 * abbe::rotation_vector(machine_from_part.rotation);
//     std::printf("bore in the machine: %.3f %.3f %.3f mm\n", bore.x(), bore.y(), bore.z());
//     std::printf("part turned by %.3f mrad about Z, tilted by %.3f about Y\n", turn_mrad.z(), turn_mrad.y());
//     std::printf("balls off by %.1f um rms\n", fit.rms * 1e3);
//     return 0;
//   }
//
// It prints:
//
//   bore in the machine: 219.926 155.100 70.005 mm
//   part turned by 0.990 mrad about Z, tilted by -0.050 about Y
//   balls off by 1.5 um rms
//
// geometry holds, without any machine:
//   rotation.h, angle_units.h           rotations, error angles, rotation vectors
//   best_fit_transform.h                the rigid motion between two sets of points, also with outliers
//   fits/shape_fit.h                    lines, planes, circles, spheres, cylinders and cones through points
//   surface/triangle_mesh.h             surfaces: closest_point.h, ray_tracer.h, mesh_check.h beside it
//   registration/registration.h         scans on surfaces from any pose; fine_registration.h from near by
//   decompositions.h                    Eigen's decompositions, compiled once

#include <Eigen/Core>
#include <Eigen/LU>

namespace abbe {

/// Rigid motion x -> rotation * x + translation.
///
/// A name tells both frames: `workpiece_from_tool * p_tool = p_workpiece`. Lengths in mm.
///
/// The products are written out, in the order in which Eigen adds with vectors of two: nearly every source of the
/// library has them, and each would compile Eigen's templates for them anew.
struct RigidTransform {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  static RigidTransform translate(const Eigen::Vector3d& offset) { return {Eigen::Matrix3d::Identity(), offset}; }
  static RigidTransform rotate(const Eigen::Matrix3d& rotation) { return {rotation, Eigen::Vector3d::Zero()}; }

  RigidTransform inverse() const {
    const double* r = rotation.data();
    Eigen::Matrix3d back;
    double* b = back.data();
    for (int i = 0; i < 3; ++i) {
      b[i] = r[3 * i];
      b[3 + i] = r[3 * i + 1];
      b[6 + i] = r[3 * i + 2];
    }
    const double x = translation[0], y = translation[1], z = translation[2];
    return {back,
            {-((r[0] * x + r[1] * y) + r[2] * z), -((r[3] * x + r[4] * y) + r[5] * z),
             -((r[6] * x + r[7] * y) + r[8] * z)}};
  }

  friend RigidTransform operator*(const RigidTransform& a, const RigidTransform& b) {
    const double *left = a.rotation.data(), *right = b.rotation.data();
    Eigen::Matrix3d turned;
    double* out = turned.data();
    for (int j = 0; j < 9; j += 3) {
      const double x = right[j], y = right[j + 1], z = right[j + 2];
      out[j] = (left[0] * x + left[3] * y) + left[6] * z;
      out[j + 1] = (left[1] * x + left[4] * y) + left[7] * z;
      out[j + 2] = left[2] * x + (left[5] * y + left[8] * z);
    }
    return {turned, a * b.translation};
  }
  friend Eigen::Vector3d operator*(const RigidTransform& a, const Eigen::Vector3d& point) {
    const double *r = a.rotation.data(), *t = a.translation.data();
    const double x = point[0], y = point[1], z = point[2];
    return {((r[0] * x + r[3] * y) + r[6] * z) + t[0], ((r[1] * x + r[4] * y) + r[7] * z) + t[1],
            (r[2] * x + (r[5] * y + r[8] * z)) + t[2]};
  }
};

}  // namespace abbe
