#include <fmt/format.h>

#include <algorithm>

#include "abbe/formats/text/input_error.h"
#include "abbe/machine/axis_unit.h"
#include "abbe/study/comparison/comparison_model.h"

namespace abbe {
namespace {

bool machine_couplings_differ(const Machine& one, const Machine& other) {
  return one.couplings.size() != other.couplings.size() ||
         !std::is_permutation(one.couplings.begin(), one.couplings.end(), other.couplings.begin());
}

void check_same_axes(const IdentifiedCampaign& first, const IdentifiedCampaign& other) {
  const auto fail = [&](const std::string& problem, const std::string& expected) {
    throw InputError({.file = other.errors_file}, problem, expected);
  };
  if (first.machine.chain() != other.machine.chain()) {
    fail("belongs to a machine \"" + other.machine.chain() + "\"",
         "the machine \"" + first.machine.chain() + "\" as in " + first.errors_file);
  }
  for (std::size_t i = 0; i < first.machine.axes.size(); ++i) {
    const Axis &a = first.machine.axes[i], &b = other.machine.axes[i];
    if (a.kind == b.kind && (a.direction - b.direction).norm() < kSameGeometry &&
        (a.point - b.point).norm() < kSameGeometry) {
      continue;
    }
    fail(fmt::format("axis {} of its machine has another direction or point than in {}", a.name, first.errors_file),
         "campaigns of one machine, described in the same way; --machine names one description for all");
  }
  if (machine_couplings_differ(first.machine, other.machine)) {
    fail("its machine has other couplings of axes than in " + first.errors_file,
         "campaigns of one machine, described in the same way; --machine names one description for all");
  }
  if (!(first.errors.errors.composition == other.errors.errors.composition)) {
    fail("its errors are composed in another order than those of " + first.errors_file,
         "the same [composition] in all campaigns");
  }
}

}  // namespace

Machine common_machine(const std::vector<IdentifiedCampaign>& campaigns) {
  Machine machine = campaigns.front().machine;
  for (const IdentifiedCampaign& other : campaigns) {
    check_same_axes(campaigns.front(), other);
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
      Axis& axis = machine.axes[i];
      const Axis& seen = other.machine.axes[i];
      if (seen.endless) continue;
      if (axis.endless) {
        axis.endless = false;
        axis.travel_min = seen.travel_min;
        axis.travel_max = seen.travel_max;
      }
      axis.travel_min = std::max(axis.travel_min, seen.travel_min);
      axis.travel_max = std::min(axis.travel_max, seen.travel_max);
      if (axis.travel_max >= axis.travel_min) continue;
      const double unit = position_unit(axis);
      throw InputError({.file = other.errors_file},
                       fmt::format("its machine's axis {} travels from {:g} to {:g} {}, outside that of the others",
                                   axis.name, seen.travel_min / unit, seen.travel_max / unit, position_suffix(axis)),
                       "travels that have positions in common");
    }
  }
  return machine;
}

}  // namespace abbe
