#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "abbe/instruments/polygon/polygon_gauge.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// One body of the nominal machine seen from another. Frame of the tool: origin at the gauge point.
/// @param positions  commands in chain order, mm or rad
RigidTransform nominal_seen(const Machine& machine, const std::vector<double>& positions, Body from, Body to);

/// Where a prism stands on its table, and from where it is looked at.
struct PolygonPlacement {
  std::size_t axis = 0;                              ///< the rotary axis: index into Machine::axes
  Body table_body = Body::workpiece;                 ///< carries the prism
  Body sensor_body = Body::bed;                      ///< carries the instruments
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< of the prism's bottom, frame of table_body, mm
  Eigen::Vector3d toward_x =
      Eigen::Vector3d::UnitX();                    ///< to the instruments along x, frame of sensor_body, any length
  Eigen::Vector3d top = Eigen::Vector3d::UnitZ();  ///< where the prism's top looks, frame of sensor_body: along
                                                   ///< the axis, either way; any length
  std::vector<double> aligned_at;                  ///< [axes] commands at which face 1 looks along toward_x
};

/// Puts bodies and nominal transforms of a placement into a set-up.
///
/// The direction of the axis is taken from the nominal machine as it turns there, so that any chain will do.
/// @throws std::invalid_argument: the axis is not rotary or does not turn one body against the other; `top` does not
///         lie along it, `toward_x` not across; the prism stands so far beside the axis that its faces leave the beams
void place_polygon(const Machine& machine, const PolygonPlacement& placement, PolygonGaugeSetup& setup);

}  // namespace abbe
