#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <nlohmann/json_fwd.hpp>

namespace abbe {

/// [x, y, z].
nlohmann::ordered_json vector_json(const Eigen::Vector3d& vector);

/// Three numbers of a list. @throws nlohmann::json::exception if they are not there
/// @param first  index of x
Eigen::Vector3d vector_of(const nlohmann::json& list, std::size_t first = 0);

}  // namespace abbe
