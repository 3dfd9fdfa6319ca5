#include "abbe/runtime/frozen_couplings.h"

#include <cmath>
#include <string_view>

#include "abbe/runtime/frozen_layout.h"

namespace abbe {

void read_frozen_couplings(Values& values, abbe_runtime& m) {
  constexpr std::string_view kField = "couplings of axes";
  const std::size_t count = values.whole(frozen::kMostCouplings, kField);
  for (std::size_t k = 0; values.ok() && k < count; ++k) {
    FrozenCoupling coupling;
    coupling.axis = values.whole(m.axes - 1, kField);
    coupling.of = values.whole(m.axes - 1, kField);
    coupling.ratio = values.number(-frozen::kLargestRatio, frozen::kLargestRatio, kField);
    values.require(coupling.axis != coupling.of, kField);
    if (!values.ok()) return;
    // What others are coupled to comes first: so no couplings go round.
    for (std::size_t before = 0; before < k; ++before) {
      values.require(m.coupling[before].of != coupling.axis, kField);
      values.require(m.coupling[before].axis != coupling.axis || m.coupling[before].of != coupling.of, kField);
    }
    m.coupling[k] = coupling;
    m.couplings = k + 1;
  }
}

bool couplings_can_be_solved(const abbe_runtime& m) {
  const auto is_solved = [&](std::size_t axis) { return m.axis[axis].solved != FrozenAxis::kNotSolved; };
  for (std::size_t k = 0; k < m.couplings; ++k) {
    if (is_solved(m.coupling[k].of) && !is_solved(m.coupling[k].axis)) return false;
  }
  return true;
}

}  // namespace abbe
