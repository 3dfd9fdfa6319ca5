#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "abbe/geometry/registration/registration.h"

namespace abbe {

/// The status in words.
std::string registration_words(const Registration& result);
/// Whether there is a pose at all, be it one of many.
bool has_pose(const Registration& result);
/// Motions that the scan does not show: "turn about the line along (0, 0, 1) through (0, 0, 0) mm".
std::vector<std::string> undetermined_words(const FineRegistration& fine);

/// What a registration found, for programs: status, part_from_scan, standard uncertainties, covariance, undetermined
/// motions and alternative poses; units in the keys.
nlohmann::ordered_json registration_json(const Registration& result);

/// The same for people.
/// @param points      of the scan
/// @param covariance  print it too
std::string registration_text(const Registration& result, Eigen::Index points, bool covariance);

}  // namespace abbe
