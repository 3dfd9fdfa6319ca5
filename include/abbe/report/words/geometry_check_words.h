#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "abbe/formats/shapes/geometry_check.h"

namespace abbe {

/// What was counted in a file, for people; complete lines.
std::string mesh_text(const CheckedMesh& mesh);
std::string cloud_text(const CheckedCloud& checked);

/// The same for programs; units in the keys.
nlohmann::ordered_json mesh_json(const CheckedMesh& mesh);
nlohmann::ordered_json cloud_json(const CheckedCloud& checked);

}  // namespace abbe
