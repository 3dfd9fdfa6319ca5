#include "abbe/errors/errors_at_pose.h"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "abbe/errors/error_states.h"

namespace abbe {

ErrorSet at_pose(const Machine& machine, const ErrorSet& errors, std::span<const double> commands) {
  if (!has_states(errors)) return errors;
  std::vector<double> sides(machine.states.size(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t j = 0; j < sides.size(); ++j) {
    if (machine.states[j].kind == StateKind::approach) sides[j] = 0;
  }
  const auto factor = [&](std::size_t state) {
    if (state == kNoState) return 1.0;
    const double value = state_factor(machine, state, commands, sides);
    if (!std::isfinite(value)) {
      throw std::invalid_argument("the state " + machine.states[state].name + " is not given");
    }
    return value;
  };
  ErrorSet result = errors;
  for (ErrorMotion& motion : result.motions) {
    const double times = factor(motion.state);
    motion.state = kNoState;
    for (double& coefficient : motion.coefficients) coefficient *= times;
    for (double& uncertainty : motion.standard_uncertainty) uncertainty *= std::abs(times);
  }
  for (LocationError& location : result.locations) {
    const double times = factor(location.state);
    location.state = kNoState;
    location.value *= times;
    location.standard_uncertainty *= std::abs(times);
  }
  return result;
}

}  // namespace abbe
