#pragma once

// Internal to formats: poses of a set-up.
#include <optional>

#include "abbe/formats/text/toml_table.h"
#include "abbe/geometry/rigid_transform.h"

namespace abbe {

/// { position_mm = [x, y, z], angles_deg = [a, b, c] }: rotation Rz(c) Ry(b) Rx(a), by default none. @throws InputError
RigidTransform read_pose(TomlTable table);

/// Where a tracker stands, and what is known of it.
struct StatedPose {
  RigidTransform body_from_station;
  bool is_known = false;  ///< else it has to be found from the readings
  bool estimate = true;
  std::optional<RigidTransform> truth{};
};

/// The keys pose ("find" or a pose), estimate_pose and true_pose. @throws InputError also for a simulation without the
/// true pose
StatedPose read_station_pose(TomlTable& table, bool simulated);

}  // namespace abbe
