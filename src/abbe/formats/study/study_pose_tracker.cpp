#include <fmt/format.h>

#include <memory>
#include <optional>

#include "abbe/formats/study/study_instrument.h"
#include "abbe/formats/study/study_pose.h"
#include "abbe/formats/study/study_quantity.h"
#include "abbe/formats/text/toml_vector.h"
#include "abbe/geometry/rotation.h"
#include "abbe/instruments/trackers/pose_tracker.h"

namespace abbe {
namespace {

PoseTrackerSetup::Target read_target(TomlTable& table, bool simulated) {
  PoseTrackerSetup::Target target;
  target.name = table.text("name");
  target.body = read_body(table, "mounted_on", Body::tool);
  target.offset = read_setup_point(table, "offset", Knowledge::exact, simulated);
  const auto rotation = [&](const char* key) -> std::optional<Eigen::Matrix3d> {
    const auto angles = table.optional_numbers(key, Quantity::angle, 3);
    if (!angles) return std::nullopt;
    return rotation_from_error_angles(vector_of(*angles));
  };
  const std::optional<Eigen::Matrix3d> given = rotation("angles");
  target.rotation = given.value_or(Eigen::Matrix3d::Identity());
  target.estimate_rotation = table.boolean_or("estimate_angles", true);
  if (!target.estimate_rotation && !given) {
    table.fail("estimate_angles", "angles that are not estimated must be given", "angles_deg = [a, b, c]");
  }
  target.true_rotation = rotation("true_angles");
  if (target.true_rotation && !simulated) {
    table.fail_quantity("true_angles", Quantity::angle, "belongs to a simulation only", "[simulate]");
  }
  table.finish();
  return target;
}

}  // namespace

std::shared_ptr<Instrument> read_pose_tracker(TomlTable& table, const InstrumentContext& context) {
  PoseTrackerSetup setup;
  setup.name = context.name;
  setup.station_body = read_body(table, "mounted_on", Body::workpiece);
  const StatedPose station = read_station_pose(table, context.simulated);
  setup.body_from_station = station.body_from_station;
  setup.pose_is_known = station.is_known;
  setup.estimate_pose = station.estimate;
  setup.true_pose = station.truth;
  if (!context.noise_from_data) {
    TomlTable noise = table.table("noise");
    setup.position_noise = read_noise(noise, "xyz", Quantity::length);
    setup.position_noise_per_length = noise.size_or("xyz", Quantity::length_per_length, 0);
    setup.turn_noise = read_noise(noise, "turn", Quantity::angle);
    noise.finish();
  }
  for (TomlTable& entry : table.tables("target")) {
    const PoseTrackerSetup::Target target = read_target(entry, context.simulated);
    if (target.body == setup.station_body) {
      entry.fail("", "the target and the instrument are on the same body, so that no axis moves between them",
                 "another mounted_on for one of them");
    }
    for (const PoseTrackerSetup::Target& other : setup.targets) {
      if (other.name != target.name) continue;
      entry.fail("name", fmt::format("another one is called \"{}\"", target.name), "different names");
    }
    setup.targets.push_back(target);
  }
  if (setup.targets.empty()) {
    table.fail("", "it is not said what is seen", "[[setup.target]] with name and offset_mm = [x, y, z]");
  }
  return std::make_shared<PoseTracker>(std::move(setup));
}

}  // namespace abbe
