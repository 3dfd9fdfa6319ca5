#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "abbe/geometry/rigid_transform.h"

namespace abbe {

/// Reads a rigid motion from CSV: columns rotation_x, rotation_y, rotation_z (the matrix, without unit) and
/// translation_mm, three rows for x, y, z; see docs/registration.md.
///
/// The matrix may be off a rotation by the digits with which it was written, 1e-5; the nearest rotation is taken.
/// @throws InputError with line, field and what was expected; also for a mirrored matrix
RigidTransform read_transform(const std::filesystem::path& path);

/// The same from the contents. @param file  name for messages
RigidTransform parse_transform(std::string_view contents, const std::string& file);

/// The file; reads back to the same bits.
std::string transform_csv(const RigidTransform& transform);

}  // namespace abbe
