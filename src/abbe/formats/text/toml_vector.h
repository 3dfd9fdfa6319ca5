#pragma once

// Internal to formats: points and vectors in TOML files.
#include <Eigen/Core>
#include <vector>

namespace abbe {

/// @param values  three
inline Eigen::Vector3d vector_of(const std::vector<double>& values) { return {values[0], values[1], values[2]}; }

}  // namespace abbe
