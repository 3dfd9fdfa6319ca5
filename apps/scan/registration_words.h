#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "abbe/geometry/registration.h"

namespace abbe {

/// What a registration found, for programs: status, part_from_scan, standard uncertainties, covariance, undetermined
/// motions and alternative poses; units in the keys.
nlohmann::ordered_json registration_json(const Registration& result);

/// The same for people.
/// @param points      of the scan
/// @param covariance  print it too
std::string registration_text(const Registration& result, Eigen::Index points, bool covariance);

}  // namespace abbe
