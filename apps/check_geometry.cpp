#include "check_geometry.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "abbe/formats/machine/file_kind.h"
#include "abbe/formats/shapes/point_cloud_file.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/json_text.h"
#include "abbe/report/words/geometry_check_words.h"
#include "exit_code.h"

namespace abbe {
namespace {

std::optional<FileLength> unit_of(const GeometryCheckOptions& options) {
  if (options.unit.empty()) return std::nullopt;
  const auto unit = file_length_named(options.unit);
  if (!unit) throw InputError({"", 0, 0, "--unit"}, fmt::format("'{}' is not a unit", options.unit), "mm, m or inch");
  return unit;
}

}  // namespace

int check_geometry(const GeometryCheckOptions& options) {
  const std::optional<FileLength> unit = unit_of(options);
  options.step.require_step_among({options.file});
  if (has_points_only(options.file)) {
    PointCloudOptions reading;
    reading.unit = unit;
    const CheckedCloud cloud = checked_cloud(read_point_cloud(options.file, reading));
    fmt::print("{}", options.json ? json_text(cloud_json(cloud)) : cloud_text(cloud));
    return kDone;
  }
  const CheckedMesh mesh = checked_mesh(options.step.read(options.file, unit));
  fmt::print("{}", options.json ? json_text(mesh_json(mesh)) : mesh_text(mesh));
  return mesh.is_sound() ? kDone : kNegative;
}

}  // namespace abbe
