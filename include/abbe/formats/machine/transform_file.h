#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "abbe/geometry/rigid_transform.h"

namespace abbe {

/// A rigid motion with what the registration that wrote it said of it.
struct TransformFile {
  RigidTransform transform;
  std::string status;  ///< of a comment line "# status: ambiguous"; empty where there is none
};

/// Reads a rigid motion from CSV: columns rotation_x, rotation_y, rotation_z (the matrix, without unit) and
/// translation_mm, three rows for x, y, z; see docs/registration.md.
///
/// The matrix may be off a rotation by the digits with which it was written, 1e-5; the nearest rotation is taken.
/// @throws InputError with line, field and what was expected; also for a mirrored matrix
RigidTransform read_transform(const std::filesystem::path& path);

/// The same from the contents. @param file  name for messages
RigidTransform parse_transform(std::string_view contents, const std::string& file);

/// The same, with the status.
TransformFile read_transform_file(const std::filesystem::path& path);
TransformFile parse_transform_file(std::string_view contents, const std::string& file);

/// The file; reads back to the same bits.
/// @param status  empty: none is written
std::string transform_csv(const RigidTransform& transform, const std::string& status = "");

}  // namespace abbe
