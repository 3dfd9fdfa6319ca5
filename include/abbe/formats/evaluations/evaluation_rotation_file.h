#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "abbe/formats/text/named_columns.h"
#include "abbe/verify/evaluations/rotation_error_motion.h"

namespace abbe {

/// Reads a CSV of displacements at an axis of rotation: `angle` and any of `x1`, `y1`, `x2`, `y2`, `axial`, `face`.
///
/// Rows are in the order of time. The angle runs on over the turns or begins anew at each one: a step of more than half
/// a turn is the start of the next turn; so the angle comes out without jumps. See docs/evaluate-geometry.md.
/// @param mapping  of a file whose columns have other names
/// @throws InputError
RotationReadings read_rotation(const std::filesystem::path& path, const ColumnMapping& mapping = {});
/// The same from text. @param file  name for messages
RotationReadings parse_rotation(std::string_view text, const std::string& file, const ColumnMapping& mapping = {});
/// The same from columns in memory, named with their units as in a file. @throws InputError
RotationReadings parse_rotation(const NamedColumns& columns);

}  // namespace abbe
