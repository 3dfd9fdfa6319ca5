#pragma once

#include <string>
#include <vector>

#include "abbe/machine/tool_path.h"
#include "abbe/verify/parts/contour_error.h"

namespace abbe {

/// What the tool leaves of a curve on the workpiece: a piece for each part on which it works, with the surface's
/// normals. A piece that comes back to its first point is closed.
/// @param file    name of the curve for messages
/// @param closed  option by which the user says that the last point is followed by the first; empty: it is not said
/// @throws InputError without a piece, for points that coincide, and for a closed curve of more pieces
std::vector<CommandPiece> commanded_pieces(const Curve& curve, const std::string& file, const std::string& closed = "");

}  // namespace abbe
