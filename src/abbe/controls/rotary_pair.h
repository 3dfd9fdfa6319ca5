#pragma once

#include <cstddef>
#include <string>

#include "abbe/machine/machine.h"

namespace abbe {

enum class RotaryPairKind { table, head, mixed };

/// The two rotary axes of a five-axis machine as controls count them.
struct RotaryPair {
  RotaryPairKind kind = RotaryPairKind::table;
  std::size_t first = 0;   ///< table or head: the axis next to the bed, which carries the other; mixed: of the tool
  std::size_t second = 0;  ///< mixed: of the table
};

/// @param format  for messages: "siemens"
/// @throws InputError with the reason for a machine that has not three linear axes along X, Y and Z which move the tool
///   in their positive direction against the workpiece, or a linear axis that a rotary one carries
void require_linear_axes(const Machine& machine, const std::string& format);

/// @param format  for messages: "siemens"
/// @throws InputError with the reason for a machine that has not two rotary axes and three linear axes along X, Y and
///   Z which move the tool in their positive direction against the workpiece, or a linear axis that a rotary one
///   carries
RotaryPair rotary_pair(const Machine& machine, const std::string& format);

}  // namespace abbe
