#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "abbe/geometry/rigid_transform.h"

namespace abbe {

/// A polygon prism with a plane mirror on top, fixed to a rotary table, seen by autocollimators and displacement
/// sensors.
///
/// Frames: `world` fixed with its origin in the table's top, z the table's axis; `table` turns with the table; `prism`
/// is fixed to the prism, origin in the centre of its bottom; `sensor`, one per sensor, nominally parallel to world.
/// Lengths in mm, angles in rad. Source: Ma et al., Applied Sciences 11 (2021) 3960, ray traced without small angles;
/// signs and orders in docs/polygon.md.

/// Where the tilt of a face is applied.
enum class PolygonFaceOrder {
  face,  ///< about the face's own horizontal edge: Rz(azimuth) Tilt, a constant of the glass
  paper  ///< about the prism's y axis (x axis for faces seen along y), equation (3): Tilt Rz(azimuth)
};

/// The axis of the world from whose positive end a sensor looks at the prism.
enum class PolygonSide { x, y, z };

/// One working face. Its normal points outwards.
struct PolygonFace {
  double azimuth = 0;        ///< nominal direction of the normal in the prism frame, from x towards y
  double azimuth_error = 0;  ///< actual minus nominal; the paper's -eps_pz
  double tilt = 0;           ///< of the normal towards +z; the paper's -eps_py along x, +eps_px along y
  double distance = 0;       ///< of the plane from the prism's origin, actual: nominal plus the face's error r_j, mm
};

/// The mirror on top: a plane at `height` above the prism's origin.
struct PolygonTop {
  double tilt_x = 0;  ///< eps_xb, about x
  double tilt_y = 0;  ///< eps_yb, about y
  double height = 0;  ///< H_b, mm
};

struct Polygon {
  std::vector<PolygonFace> faces;
  PolygonFaceOrder order = PolygonFaceOrder::face;
  PolygonTop top;
  /// Half the nominal width of a face of a regular polygon: distance * tan(pi/n), mm. The 12.94 mm of the paper.
  double half_face_width() const;
};

/// Regular prism without errors; face j looks in direction -2 pi j / n of the prism, so that the table's positive
/// motion by j steps brings face j to where face 0 was.
/// @throws std::invalid_argument fewer than three faces, or a length that is not positive
Polygon regular_polygon(std::size_t faces, double distance, double height);

/// How the prism stands on the table: `table_from_prism` = [Ry(ey) Rx(ex) Rz(turn + ez) | offset].
struct PolygonMount {
  Eigen::Vector3d angles = Eigen::Vector3d::Zero();  ///< eps_xbc, eps_ybc, and ez about the prism's axis
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  ///< delta_xbc, delta_ybc, delta_zbc, mm
  double turn = 0;                                   ///< nominal, for a prism put on again turned by some faces
};

/// The six error motions of the table at one position: world_from_table = [Ry(ey) Rx(ex) Rz(angle + ez) |
/// displacement].
struct TableMotion {
  Eigen::Vector3d angles = Eigen::Vector3d::Zero();        ///< eps_x, eps_y, eps_z
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  ///< delta_x, delta_y, delta_z, mm
};

/// An autocollimator or displacement sensor: world_from_sensor = [Rz Ry Rx | position].
///
/// Its beam leaves at `exit` against the sensor's own axis named by `side`.
struct PolygonSensor {
  PolygonSide side = PolygonSide::x;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Vector3d angles = Eigen::Vector3d::Zero();
  Eigen::Vector3d exit = Eigen::Vector3d::Zero();  ///< sensor frame, mm
};

/// What is read at one position of the table. Autocollimators: tan(2 omega)/2 of the normal against the sensor's axis,
/// as the paper defines it, rad. Displacement sensors: coordinate of the hit point along the sensor's axis, mm.
enum class PolygonReading {
  autocollimator_x_about_z,
  autocollimator_x_about_y,
  autocollimator_y_about_x,
  autocollimator_y_about_z,
  displacement_x,
  displacement_y,
  displacement_z
};
constexpr std::size_t kPolygonReadings = 7;
constexpr bool is_angle(PolygonReading reading) { return reading < PolygonReading::displacement_x; }

/// What an autocollimator takes of the normal: the sensor's axis that the reading compares with its own, and the sign
/// with which a turn about the axis named in the reading is positive.
struct PolygonAcross {
  int axis;
  double sign;
};
constexpr PolygonAcross across_of(PolygonReading reading) {
  switch (reading) {
    case PolygonReading::autocollimator_x_about_z:
      return {1, 1};
    case PolygonReading::autocollimator_x_about_y:
      return {2, -1};
    case PolygonReading::autocollimator_y_about_x:
      return {2, 1};
    default:
      return {0, -1};
  }
}
/// "autocollimator_x_about_z", ...
const char* reading_name(PolygonReading reading);

/// The instruments of one measurement.
struct PolygonBench {
  PolygonSensor autocollimator_x, autocollimator_y, displacement_x, displacement_y, displacement_z;

  /// Around the prism of the paper: 100 mm from the axis at half its height of 17 mm, and 100 mm above the table.
  PolygonBench();
  const PolygonSensor& sensor(PolygonReading reading) const;
  PolygonSensor& sensor(PolygonReading reading);
};

/// Checks that every beam nominally meets its face and that all numbers are finite.
/// @throws std::invalid_argument naming the sensor, what it is in mm and what was expected
void validate(const Polygon& polygon, const PolygonBench& bench);

/// One position of the table.
struct PolygonPosition {
  double angle = 0;        ///< commanded, rad
  std::size_t face_x = 0;  ///< index into Polygon::faces of the face that the sensors along x see
  std::size_t face_y = 0;
};

/// Position number `step` of a regular polygon: angle 2 pi step / n, faces by the number of faces the mount is turned.
/// @param shift  PolygonMount::turn in faces
/// @throws std::invalid_argument if n is not divisible by four: no face then looks along y while one looks along x
PolygonPosition regular_position(std::size_t faces, std::size_t step, std::size_t shift = 0);

/// A plane: normal . x = offset; unit normal.
struct ReflectingPlane {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitX();
  double offset = 0;  ///< mm
};

/// Columns of a reading's gradient.
namespace polygon_column {
constexpr int motion = 0;          ///< eps_x, eps_y, eps_z, delta_x, delta_y, delta_z
constexpr int mount = 6;           ///< the same for the mount
constexpr int face = 12;           ///< azimuth_error, tilt, distance; of readings along z: tilt_x, tilt_y, height
constexpr int sensor_angles = 15;  ///< 3
constexpr int position = 18;       ///< 3
constexpr int exit = 21;           ///< 3
constexpr int count = 24;
}  // namespace polygon_column

using PolygonGradient = Eigen::Matrix<double, polygon_column::count, 1>;

/// Face (or top, for side z) in the prism frame.
/// @param slopes  null or out: derivatives of (normal, offset) by the three numbers of polygon_column::face
ReflectingPlane plane_in_prism(const Polygon& polygon, PolygonSide side, std::size_t face,
                               Eigen::Matrix<double, 4, 3>* slopes = nullptr);

/// The same plane in the table's frame turned by the commanded angle: before the table's error motion.
ReflectingPlane plane_before_motion(const ReflectingPlane& in_prism, const PolygonMount& mount, double angle);

/// ... and with the table's error motion, in the world. Small components keep their relative accuracy.
ReflectingPlane plane_in_world(const ReflectingPlane& before_motion, const TableMotion& motion);

/// What a sensor reads of a plane given in the world. NaN if the beam does not meet it (a sensor that looks elsewhere).
double read_plane(PolygonReading reading, const PolygonSensor& sensor, const ReflectingPlane& plane);

/// One reading, ray traced: no small angles.
///
/// @param gradient  null or out: analytic derivatives by what polygon_column names; rad or mm per rad or mm
/// @throws nothing; face indices must be valid
double polygon_reading(PolygonReading reading, const Polygon& polygon, const PolygonMount& mount,
                       const PolygonBench& bench, const PolygonPosition& position, const TableMotion& motion,
                       PolygonGradient* gradient = nullptr);

}  // namespace abbe
