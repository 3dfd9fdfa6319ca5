#include "liu/machine.h"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "abbe/errors/actual_pose.h"
#include "abbe/formats/files/text_file.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/text/csv_reader.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/geometry/rotation.h"
#include "abbe/instruments/virtual_scan.h"
#include "shared_file.h"

namespace abbe {
namespace {

double unit_of(LiuUnit unit) { return unit == LiuUnit::millimetre ? 1.0 : 1e-3; }

/// A line about which something turns.
struct Line {
  Eigen::Vector3d point, direction;

  RigidTransform turn(double angle) const {
    const Eigen::Matrix3d rotation = rotation_about(direction, angle);
    return {rotation, point - rotation * point};
  }
  Line moved(const RigidTransform& motion) const { return {motion * point, motion.rotation * direction}; }
};

/// Axis average line of a stage: what its half turn leaves where it is.
Line axis_line(const Machine& machine, const ErrorSet& errors, std::size_t axis) {
  const RigidTransform half = actual_motion(machine, errors, axis, std::numbers::pi);
  // R = 2 d d' - 1 and t = (1 - R) p = 2 (p - d d'p).
  const Eigen::Matrix3d projection = 0.5 * (half.rotation + Eigen::Matrix3d::Identity());
  const Eigen::Vector3d direction = projection * machine.axes[axis].direction;
  return {0.5 * half.translation, direction.normalized()};
}

}  // namespace

const char* liu_unit_name(LiuUnit unit) { return unit == LiuUnit::millimetre ? "mm" : "um"; }

Machine liu_machine() { return read_machine(shared_file("examples/machines/liu-scanner.machine.toml")); }

ErrorSet liu_errors(const Machine& machine, LiuUnit unit, double angles, double shifts) {
  const std::size_t a = machine.find_axis("A"), c = machine.find_axis("C");
  const double a1 = angles * 0.0741 * kDegree, a2 = angles * 0.3413 * kDegree;
  const double c1 = angles * 0.5035 * kDegree, c2 = angles * -0.8466 * kDegree;
  const double scale = shifts * unit_of(unit);
  using enum Component;
  ErrorSet errors;
  errors.locations = {
      {a, Y, (-0.0012 - 0.8424 * std::tan(a1)) * scale, 0}, {a, Z, (0.0177 - 0.8424 * std::tan(a2)) * scale, 0},
      {a, B, -std::atan(std::tan(a2) * std::cos(a1)), 0},   {a, C, a1, 0},
      {c, X, (0.2906 - 0.5074 * std::tan(c1)) * scale, 0},  {c, Z, (0.6875 - 0.5074 * std::tan(c2)) * scale, 0},
      {c, A, std::atan(std::tan(c2) * std::cos(c1)), 0},    {c, C, -c1, 0}};
  return errors;
}

ErrorSet liu_unknowns(const Machine& machine) { return liu_errors(machine, LiuUnit::millimetre, 0, 0); }

RigidTransform liu_clamping(LiuUnit unit) {
  const auto& [tilt_x, tilt_z, shift_x, shift_z] = kLiuTable3Clamping;
  return {rotation_from_error_angles({tilt_x * kDegree, 0, tilt_z * kDegree}),
          Eigen::Vector3d(shift_x, 0, shift_z) * unit_of(unit)};
}

Eigen::Matrix3Xd liu_points(const Machine& machine, const ErrorSet& errors, const PoseList& positions,
                            const std::vector<double>& indication) {
  VirtualScan scan;
  scan.positions = positions;
  scan.indication = indication;
  ProbeBeam beam;
  beam.direction = -machine.tool_direction;
  return scanned_points(machine, errors, beam, scan);
}

LiuReference read_liu_reference(const Machine& machine) {
  const auto path = shared_file("golden/liu/points.csv");
  const MappedFile file(path);
  std::vector<CsvColumn> wanted;
  for (const char* name : {"x", "y", "z", "h"}) wanted.push_back({name, Quantity::length});
  for (const char* name : {"A", "C"}) wanted.push_back({name, Quantity::angle});
  for (const char* set : {"nominal_", "t3mm_", "t3um_"}) {
    for (const char* coordinate : {"x", "y", "z"}) {
      wanted.push_back({std::string(set) + coordinate, Quantity::dimensionless});
    }
  }
  const CsvTable table = read_csv(file.text(), path.string(), wanted);
  LiuReference reference;
  const std::array<const char*, 5> axes = {"X", "Y", "Z", "A", "C"};
  const std::array<std::size_t, 5> columns = {0, 1, 2, 4, 5};
  reference.positions.axis.resize(machine.axes.size());
  for (std::size_t i = 0; i < axes.size(); ++i) {
    reference.positions.axis[machine.find_axis(axes[i])] = table.columns[columns[i]].numbers;
  }
  reference.indication = table.columns[3].numbers;
  const auto rows = static_cast<Eigen::Index>(table.rows);
  std::size_t column = 6;
  for (Eigen::Matrix3Xd* points : {&reference.nominal, &reference.millimetre, &reference.micrometre}) {
    points->resize(3, rows);
    for (Eigen::Index i = 0; i < 3; ++i, ++column) {
      points->row(i) = Eigen::Map<const Eigen::RowVectorXd>(table.columns[column].numbers.data(), rows);
    }
  }
  return reference;
}

Eigen::Matrix3Xd liu_recursion(const Machine& machine, const ErrorSet& errors, const PoseList& positions,
                               const std::vector<double>& indication, LiuRecursion form) {
  const std::size_t a = machine.find_axis("A"), c = machine.find_axis("C");
  const std::array<std::size_t, 3> linear = {machine.find_axis("X"), machine.find_axis("Y"), machine.find_axis("Z")};
  // Zero of the indication, a point further up the beam, and the directions in which the linear axes move the probe.
  Eigen::Vector3d reference = machine.tool_reference, pupil = reference + machine.tool_direction;
  Eigen::Matrix3d directions;
  for (int i = 0; i < 3; ++i) directions.col(i) = machine.axes[linear[static_cast<std::size_t>(i)]].direction;
  Line a_line = axis_line(machine, errors, a), c_line = axis_line(machine, errors, c);
  std::vector<double> last(machine.axes.size(), 0.0);
  Eigen::Matrix3Xd points(3, static_cast<Eigen::Index>(positions.count()));
  for (std::size_t k = 0; k < positions.count(); ++k) {
    const std::vector<double> now = positions.pose(k);
    Eigen::Vector3d increment;
    for (int i = 0; i < 3; ++i) {
      const std::size_t axis = linear[static_cast<std::size_t>(i)];
      increment[i] = now[axis] - last[axis];
    }
    const RigidTransform by_a = a_line.turn(-(now[a] - last[a])), by_c = c_line.turn(-(now[c] - last[c]));
    const RigidTransform motion = form == LiuRecursion::corrected ? by_c * by_a : by_a * by_c;
    reference = motion * Eigen::Vector3d(reference + directions * increment);
    pupil = motion * Eigen::Vector3d(pupil + directions * increment);
    directions = (motion.rotation * directions).eval();
    if (form == LiuRecursion::corrected) {
      a_line = a_line.moved(by_c);
    } else {
      c_line = c_line.moved(by_a);
    }
    // P = P_ref - h m; (6) has the other sign.
    points.col(static_cast<Eigen::Index>(k)) = reference - indication[k] * (pupil - reference).normalized();
    last = now;
  }
  return points;
}

}  // namespace abbe
