#pragma once

#include <cstddef>
#include <vector>

#include "abbe/machine/machine.h"

namespace abbe {

/// Indices of axes as controls count them, whatever carries what: those named X Y Z A B C U V W alone, in this order,
/// then the others ("C1") as in the chain. The LinuxCNC module takes its joints in the same order if it is not told
/// another one.
std::vector<std::size_t> joint_order(const Machine& machine);

}  // namespace abbe
