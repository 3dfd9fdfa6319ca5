#pragma once

#include <string>

#include "abbe/geometry/surface/triangle_mesh.h"

namespace abbe {

/// A part as planners need it: vertices at the same place become one, and the surface encloses a volume.
/// @param file  name for messages
/// @throws InputError for a surface that is not closed, not oriented, or turned inwards
TriangleMesh closed_part(const TriangleMesh& mesh, const std::string& file);

}  // namespace abbe
