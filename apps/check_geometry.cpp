#include "check_geometry.h"

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "abbe/formats/files/text_file.h"
#include "abbe/formats/shapes/ending.h"
#include "abbe/formats/shapes/ply_file.h"
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

/// True for a PLY or OBJ file that has points but no faces.
bool has_points_only(const std::string& file) {
  const MappedFile mapped(file);
  if (is_ply(mapped.text())) return parse_ply(mapped.text(), file).triangles.cols() == 0;
  // An OBJ file is read as a mesh; if it has no faces, that is said.
  return false;
}

}  // namespace

bool is_geometry_file(const std::string& file) {
  const std::string name = with_ending(std::filesystem::path(file));
  return has_mesh_extension(name) || has_point_cloud_extension(name);
}

int check_geometry(const GeometryCheckOptions& options) {
  const std::optional<FileLength> unit = unit_of(options);
  options.step.require_step_among({options.file});
  if (has_point_cloud_extension(with_ending(std::filesystem::path(options.file))) || has_points_only(options.file)) {
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
