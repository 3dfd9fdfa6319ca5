#pragma once

// Internal to formats: directions in a study file.
#include <Eigen/Core>
#include <optional>
#include <string_view>

#include "abbe/formats/text/toml_table.h"

namespace abbe {

/// Three pure numbers, not all zero; as they stand, not normalised.
/// @param otherwise  if the file has none; nothing: it is required
Eigen::Vector3d read_direction(TomlTable& table, std::string_view key,
                               std::optional<Eigen::Vector3d> otherwise = std::nullopt);

}  // namespace abbe
