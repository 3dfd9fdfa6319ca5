#include "abbe/formats/text/vector_json.h"

#include <nlohmann/json.hpp>

namespace abbe {

nlohmann::ordered_json vector_json(const Eigen::Vector3d& vector) { return {vector.x(), vector.y(), vector.z()}; }

Eigen::Vector3d vector_of(const nlohmann::json& list, std::size_t first) {
  return {list.at(first).get<double>(), list.at(first + 1).get<double>(), list.at(first + 2).get<double>()};
}

}  // namespace abbe
