#pragma once

#include <cstddef>
#include <string>

namespace abbe::benchmarks {

/// Triangles that Open3D finds in a file; 0 if it cannot read it.
std::size_t open3d_triangles(const std::string& path);

}  // namespace abbe::benchmarks
