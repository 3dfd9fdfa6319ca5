#pragma once

#include <array>
#include <string>
#include <vector>

#include "liu/machine.h"

namespace abbe {

/// Influence of one error term on the points of a scan.
struct LiuTerm {
  std::string name;   ///< "EB0A", "dX (dynamic)", "tilt about x"
  std::size_t group;  ///< index into LiuSensitivity::groups
  bool is_angle = false;
  double stated = 0, as_found = 0;  ///< standard deviation by the ranges of section 4.1, size by Table 3; mm or rad
  double across = 0;                ///< root mean square change along the normal per unit, mm per mm or mm per rad
  double remaining = 0;             ///< the same, after the best rigid motion of the part is taken out
};

struct LiuGroup {
  std::string name;
  double paper = 0;  ///< per cent, Table 1
  /// Shares of the sum of root mean squares, per cent: by the stated ranges and by the sizes of Table 3, as points move
  /// and as a registration leaves it.
  double stated = 0, stated_remaining = 0, as_found = 0, as_found_remaining = 0;
};

struct LiuSensitivity {
  std::vector<LiuTerm> terms;
  std::array<LiuGroup, 6> groups;
};

/// Sensitivities of a scan of the cross cylinder, from the exact derivatives of the chain.
LiuSensitivity liu_sensitivity(const Machine& machine);

}  // namespace abbe
