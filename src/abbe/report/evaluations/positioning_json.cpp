#include "abbe/report/evaluations/positioning_json.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "abbe/geometry/angle_units.h"

namespace abbe {

nlohmann::ordered_json position_json(const PositioningParameters& parameters) {
  nlohmann::ordered_json json;
  const char* const names[] = {"x_mm", "y_mm", "z_mm", "alpha_deg", "beta_deg", "gamma_deg"};
  for (Eigen::Index i = 0; i < 6; ++i) {
    const double unit = i < 3 ? 1 : kDegree;
    json[names[i]] = (i < 3 ? parameters.translation[i] : parameters.angles[i - 3]) / unit;
    json["u_" + std::string(names[i])] = std::sqrt(std::max(0.0, parameters.covariance(i, i))) / unit;
  }
  return json;
}

}  // namespace abbe
