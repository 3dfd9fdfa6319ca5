#pragma once

#include "abbe/geometry/angle_units.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// The unit in which people and files state positions of an axis, in mm or rad: mm or degrees.
inline double position_unit(AxisKind kind) { return kind == AxisKind::rotary ? kDegree : 1; }
inline double position_unit(const Axis& axis) { return position_unit(axis.kind); }

/// Its name: "mm" or "deg".
inline const char* position_suffix(AxisKind kind) { return kind == AxisKind::rotary ? "deg" : "mm"; }
inline const char* position_suffix(const Axis& axis) { return position_suffix(axis.kind); }

/// From mm or rad to um or urad, and the name of that unit.
inline double micro_per_unit(bool angle) { return angle ? 1e6 : 1e3; }
inline const char* micro_unit(bool angle) { return angle ? "urad" : "um"; }

/// A scale is a pure number; people state it in um/m.
constexpr double kPurePerUnit = 1e6;
constexpr const char* kPureUnit = "um/m";

}  // namespace abbe
