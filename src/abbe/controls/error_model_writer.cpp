#include "abbe/controls/error_model_writer.h"

#include <cmath>
#include <utility>

namespace abbe {

ErrorSet wanted_errors(const Machine& machine, const ErrorSet& errors, const WriterRequest& request) {
  ErrorSet written;
  for (const ErrorMotion& motion : errors.motions) {
    if (!request.axes[motion.axis]) continue;
    if (request.left_out.count(error_motion_name(machine, motion.axis, motion.component)) != 0) continue;
    written.motions.push_back(motion);
  }
  for (const LocationError& location : errors.locations) {
    if (!request.axes[location.axis]) continue;
    if (request.left_out.count(location_error_name(machine, location.axis, location.component)) != 0) continue;
    written.locations.push_back(location);
  }
  return written;
}

WrittenTable summary_of(std::string name, const std::vector<double>& positions,
                        const std::vector<double>& corrections) {
  WrittenTable summary;
  summary.name = std::move(name);
  summary.nodes = positions.size();
  summary.step = positions.size() > 1 ? positions[1] - positions[0] : 0;
  for (std::size_t k = 0; k < positions.size(); ++k) {
    if (std::abs(corrections[k]) < summary.largest) continue;
    summary.largest = std::abs(corrections[k]);
    summary.largest_at = positions[k];
  }
  const std::size_t every = positions.size() / 40 + 1;
  for (std::size_t k = 0; k < positions.size(); k += every) {
    summary.positions.push_back(positions[k]);
    summary.corrections.push_back(corrections[k]);
  }
  return summary;
}

WrittenTable summary_of(const Machine& machine, const LocationError& location) {
  WrittenTable summary;
  summary.name = location_error_name(machine, location.axis, location.component);
  summary.nodes = 1;
  summary.is_angle = is_rotation(location.component);
  summary.largest = std::abs(location.value);
  summary.corrections = {-location.value};
  summary.values = [axis = location.axis, component = location.component](const ErrorSet& errors) {
    double value = 0;
    for (const LocationError& one : errors.locations) {
      if (one.axis == axis && one.component == component) value -= one.value;
    }
    return std::vector<double>{value};
  };
  return summary;
}

}  // namespace abbe
