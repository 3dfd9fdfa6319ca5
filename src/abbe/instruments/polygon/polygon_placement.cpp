#include "abbe/instruments/polygon/polygon_placement.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <numbers>
#include <stdexcept>

#include "abbe/geometry/angle_units.h"

namespace abbe {
namespace {

constexpr double kAlong = 0.999;  // cosine of 2.6 degrees: more is another direction, not an error of alignment

RigidTransform in_machine(const Machine& machine, const std::vector<double>& positions, Body body) {
  if (body == Body::bed) return {};
  if (body == Body::workpiece) return nominal_bed_from_workpiece(machine, positions);
  return nominal_bed_from_tool(machine, positions) * RigidTransform::translate(-machine.tool_offset);
}

}  // namespace

RigidTransform nominal_seen(const Machine& machine, const std::vector<double>& positions, Body from, Body to) {
  return in_machine(machine, positions, to).inverse() * in_machine(machine, positions, from);
}

void place_polygon(const Machine& machine, const PolygonPlacement& placement, PolygonGaugeSetup& setup) {
  const Axis& axis = machine.axes.at(placement.axis);
  if (axis.kind != AxisKind::rotary) throw std::invalid_argument(axis.name + " is not a rotary axis");
  const auto seen_at = [&](double turn) {
    std::vector<double> positions = placement.aligned_at;
    positions.at(placement.axis) += turn;
    return nominal_seen(machine, positions, placement.table_body, placement.sensor_body);
  };
  const RigidTransform aligned = seen_at(0), quarter = seen_at(std::numbers::pi / 2), half = seen_at(std::numbers::pi);
  const Eigen::AngleAxisd turn(Eigen::Matrix3d(quarter.rotation * aligned.rotation.transpose()));
  if (turn.angle() < 1) {
    throw std::invalid_argument(axis.name + " does not turn the prism before the sensors: both stand on the same side");
  }
  Eigen::Vector3d z = turn.axis();
  const double along = z.dot(placement.top.normalized());
  if (std::abs(along) < kAlong) {
    throw std::invalid_argument(fmt::format("the top looks {:.3g} deg aside of the line of {}",
                                            std::acos(std::min(std::abs(along), 1.0)) / kDegree, axis.name));
  }
  if (along < 0) z = -z;
  Eigen::Vector3d x = placement.toward_x.normalized();
  if (std::abs(x.dot(z)) > std::sqrt(1 - kAlong * kAlong)) {
    throw std::invalid_argument("the sensors along x do not look across the line of " + axis.name);
  }
  x = (x - x.dot(z) * z).normalized();
  setup.table_body = placement.table_body;
  setup.sensor_body = placement.sensor_body;
  setup.sensors_from_bench.rotation << x, z.cross(x), z;
  setup.sensors_from_bench.translation = aligned * placement.centre;
  setup.table_from_prism = {aligned.rotation.transpose() * setup.sensors_from_bench.rotation, placement.centre};
  const Eigen::Vector3d across = half * placement.centre - aligned * placement.centre;
  const double beside = (across - across.dot(z) * z).norm() / 2;
  if (beside > setup.polygon.half_face_width()) {
    throw std::invalid_argument(
        fmt::format("the prism stands {:.6g} mm beside the line of {}, and half the width of a "
                    "face is {:.6g} mm",
                    beside, axis.name, setup.polygon.half_face_width()));
  }
}

}  // namespace abbe
