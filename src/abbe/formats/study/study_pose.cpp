#include "abbe/formats/study/study_pose.h"

#include "abbe/formats/text/toml_vector.h"
#include "abbe/geometry/rotation.h"

namespace abbe {

RigidTransform read_pose(TomlTable table) {
  Eigen::Vector3d angles = Eigen::Vector3d::Zero();
  const Eigen::Vector3d position = vector_of(table.numbers("position", Quantity::length, 3));
  if (const auto stated = table.optional_numbers("angles", Quantity::angle, 3)) angles = vector_of(*stated);
  table.finish();
  return {rotation_from_error_angles(angles), position};
}

StatedPose read_station_pose(TomlTable& table, bool simulated) {
  StatedPose station;
  bool find = !table.has("pose");
  if (table.has("pose") && table.is_text("pose")) {
    find = true;
    if (table.text("pose") != "find") table.fail("pose", "unknown word", "\"find\" or { position_mm, angles_deg }");
  } else if (auto pose = table.optional_table("pose")) {
    station.body_from_station = read_pose(*pose);
  }
  station.is_known = !find;
  station.estimate = table.boolean_or("estimate_pose", true);
  if (!station.estimate && find) {
    table.fail("estimate_pose", "a pose that is not estimated has to be given", "pose = { position_mm, angles_deg }");
  }
  if (auto pose = table.optional_table("true_pose")) {
    if (!simulated) table.fail("true_pose", "belongs to a simulation only", "[simulate]");
    station.truth = read_pose(*pose);
  }
  if (simulated && find && !station.truth) {
    table.fail("", "a simulation needs the true pose",
               "true_pose = { position_mm = [x, y, z], angles_deg = [a, b, c] }");
  }
  return station;
}

}  // namespace abbe
