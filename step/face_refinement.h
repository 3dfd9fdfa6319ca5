#pragma once

#include <TopoDS_Face.hxx>

#include "face_deviation.h"
#include "time_limit.h"

namespace abbe {

/// Makes the triangles of a face finer where they are farther from its surface than the chord, which OpenCASCADE's
/// mesher leaves some of them, however fine the others are. Sides between two triangles are halved, in the parameters
/// of the surface; those along the edges of the face stay, so that the triangles of its neighbours still meet them.
///
/// Ends where the chord is kept but for what no division can avoid (unavoidable_mm()), or where halving does not bring
/// it any nearer: then the edges decide.
/// @throws std::runtime_error if the face has no triangles, TimeIsUp
FaceDeviation refine_face(const TopoDS_Face& face, double chord_mm, const TimeLimit& limit);

}  // namespace abbe
