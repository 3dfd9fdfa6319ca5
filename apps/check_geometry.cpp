#include "check_geometry.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "abbe/formats/input_error.h"
#include "abbe/formats/json_text.h"
#include "abbe/formats/mesh_file.h"
#include "abbe/formats/ply_file.h"
#include "abbe/formats/point_cloud_file.h"
#include "abbe/formats/text_file.h"
#include "abbe/formats/vector_json.h"
#include "abbe/geometry/mesh_check.h"
#include "abbe/geometry/vertex_welder.h"
#include "exit_code.h"

namespace abbe {
namespace {

using Json = nlohmann::ordered_json;

std::optional<FileLength> unit_of(const GeometryCheckOptions& options) {
  if (options.unit.empty()) return std::nullopt;
  const auto unit = file_length_named(options.unit);
  if (!unit) throw InputError({"", 0, 0, "--unit"}, fmt::format("'{}' is not a unit", options.unit), "mm, m or inch");
  return unit;
}

std::string words(const Eigen::Vector3d& v) { return fmt::format("({:.9g}, {:.9g}, {:.9g})", v.x(), v.y(), v.z()); }

const char* source_name(UnitSource source) {
  return source == UnitSource::stated ? "stated" : source == UnitSource::given ? "given" : "assumed";
}

Json head_json(const std::string& kind, const std::string& format, const FileUnit& unit) {
  Json json;
  json["kind"] = kind;
  json["format"] = format;
  json["file_unit"] = file_length_name(unit.length);
  json["file_unit_is"] = source_name(unit.source);
  return json;
}

/// Points beyond the first at the same place.
std::size_t repeated_points(const Eigen::Matrix3Xd& points) {
  const auto count = static_cast<std::size_t>(points.cols());
  VertexWelder welder(count);
  std::vector<std::uint32_t> indices(count);
  welder.add({points.data(), 3 * count}, indices.data());
  return count - welder.size();
}

/// A mesh with what was counted in it.
struct CheckedMesh {
  MeshFile file;
  MeshCheck check;
  std::size_t repeated = 0;

  bool is_inside_out() const { return check.encloses_volume() && check.volume < 0; }
  /// Nothing is left out, and inside and outside are told apart wherever there is a surface.
  bool is_sound() const {
    return file.left_out.empty() && check.is_oriented() && check.branching_edges == 0 &&
           check.duplicate_triangles == 0 && !is_inside_out();
  }
};

std::string verdict(const CheckedMesh& mesh) {
  const MeshCheck& check = mesh.check;
  std::vector<std::string> words;
  if (!mesh.file.left_out.empty()) words.push_back(incomplete_words(mesh.file));
  if (check.encloses_volume()) {
    words.push_back(mesh.is_inside_out() ? "closed, but inside out: every triangle is turned over"
                                         : "closed, turned outwards");
  } else if (check.border_edges > 0) {
    words.push_back(
        fmt::format("open: {} {} no volume", check.rims, check.rims == 1 ? "hole or outline," : "holes or outlines,"));
  } else {
    words.emplace_back("no volume");
  }
  if (check.turned_edges > 0) words.emplace_back("neighbours turned against each other");
  if (check.branching_edges > 0) words.emplace_back("edges of more than two triangles");
  if (check.duplicate_triangles > 0) words.emplace_back("triangles that occur more than once");
  if (mesh.repeated > 0)
    words.emplace_back("vertices at one place that are not shared, so that the mesh may be open only there");
  return fmt::format("{}", fmt::join(words, "; "));
}

void print_box(const Eigen::Vector3d& lower, const Eigen::Vector3d& upper) {
  fmt::print("{:<22} {} to {} mm\n", "box", words(lower), words(upper));
  fmt::print("{:<22} {} mm\n", "size", words(upper - lower));
}

void print_mesh(const CheckedMesh& mesh) {
  const MeshCheck& check = mesh.check;
  fmt::print("mesh, {}; unit of the file: {}\n\n", mesh.file.format, unit_words(mesh.file.unit));
  const auto line = [](const char* name, std::size_t count, const char* remark = "") {
    fmt::print("{:<22} {}{}\n", name, count, count > 0 ? remark : "");
  };
  if (mesh.file.faces > 0) line(mesh.file.has_exact_faces() ? "faces" : "groups", mesh.file.faces);
  line("triangles", check.triangles);
  line("vertices", check.vertices);
  line("edges", check.edges);
  line("parts", check.parts);
  line("border edges", check.border_edges, "  (of one triangle)");
  line("holes or outlines", check.rims, "  (lines of border edges)");
  line("branching edges", check.branching_edges, "  (of more than two triangles: not a manifold)");
  line("turned edges", check.turned_edges, "  (neighbours turned against each other)");
  line("degenerate triangles", check.degenerate_triangles, "  (no area)");
  line("duplicate triangles", check.duplicate_triangles);
  line("repeated vertices", mesh.repeated, "  (at the place of another one)");
  line("unused vertices", check.unused_vertices);
  print_box(check.lower, check.upper);
  fmt::print("{:<22} {:.9g} mm2\n", "area", check.area);
  if (check.encloses_volume()) fmt::print("{:<22} {:.9g} mm3\n", "volume", check.volume);
  if (mesh.file.has_exact_faces())
    fmt::print("{:<22} {:.3g} mm of the exact faces\n", "triangles within", mesh.file.deviation_mm);
  fmt::print("\n{}\n", verdict(mesh));
  for (const std::string& note : mesh.file.notes) fmt::print("note: {}\n", note);
}

Json mesh_json(const CheckedMesh& mesh) {
  const MeshCheck& check = mesh.check;
  Json json = head_json("mesh", mesh.file.format, mesh.file.unit);
  json["triangles"] = check.triangles;
  json["vertices"] = check.vertices;
  json["edges"] = check.edges;
  json["parts"] = check.parts;
  json["border_edges"] = check.border_edges;
  json["rims"] = check.rims;
  json["branching_edges"] = check.branching_edges;
  json["turned_edges"] = check.turned_edges;
  json["degenerate_triangles"] = check.degenerate_triangles;
  json["duplicate_triangles"] = check.duplicate_triangles;
  json["repeated_vertices"] = mesh.repeated;
  json["unused_vertices"] = check.unused_vertices;
  json["closed"] = check.is_closed();
  json["oriented"] = check.is_oriented();
  json["sound"] = mesh.is_sound();
  json["lower_mm"] = vector_json(check.lower);
  json["upper_mm"] = vector_json(check.upper);
  json["area_mm2"] = check.area;
  // No number where there is none.
  json["volume_mm3"] = check.encloses_volume() ? Json(check.volume) : Json();
  if (mesh.file.faces > 0) {
    json["faces"] = mesh.file.faces;
    if (mesh.file.has_exact_faces()) {
      json["deviation_mm"] = mesh.file.deviation_mm;
      json["left_out"] = mesh.file.left_out;
      json["left_out_share"] = mesh.file.left_out_share ? Json(*mesh.file.left_out_share) : Json();
    } else {
      json["face_names"] = mesh.file.face_names;
    }
  }
  json["verdict"] = verdict(mesh);
  json["notes"] = mesh.file.notes;
  return json;
}

int check_cloud(const PointCloudFile& file, bool json_wanted) {
  const PointCloud& cloud = file.cloud;
  const Eigen::Vector3d lower = cloud.points.rowwise().minCoeff(), upper = cloud.points.rowwise().maxCoeff();
  const Eigen::Vector3d middle = 0.5 * (lower + upper);
  const Eigen::Vector3d centroid = middle + (cloud.points.colwise() - middle).rowwise().mean();
  const std::size_t repeated = repeated_points(cloud.points);
  if (json_wanted) {
    Json json = head_json("point_cloud", file.format, file.unit);
    json["points"] = cloud.size();
    json["repeated_points"] = repeated;
    json["normals"] = cloud.has_normals();
    json["deviations"] = !file.deviation_mm.empty();
    json["lower_mm"] = vector_json(lower);
    json["upper_mm"] = vector_json(upper);
    json["centroid_mm"] = vector_json(centroid);
    fmt::print("{}", json_text(json));
    return kDone;
  }
  fmt::print("point cloud, {}; unit of the file: {}\n\n", file.format, unit_words(file.unit));
  fmt::print("{:<22} {}\n", "points", cloud.size());
  fmt::print("{:<22} {}{}\n", "repeated points", repeated, repeated > 0 ? "  (at the place of another one)" : "");
  fmt::print("{:<22} {}\n", "normals", cloud.has_normals() ? "yes" : "no");
  print_box(lower, upper);
  fmt::print("{:<22} {} mm\n", "centroid", words(centroid));
  return kDone;
}

/// True for a PLY or OBJ file that has points but no faces.
bool has_points_only(const std::string& file) {
  const MappedFile mapped(file);
  if (is_ply(mapped.text())) return parse_ply(mapped.text(), file).triangles.cols() == 0;
  // An OBJ file is read as a mesh; if it has no faces, that is said.
  return false;
}

}  // namespace

bool is_geometry_file(const std::string& file) { return has_mesh_extension(file) || has_point_cloud_extension(file); }

int check_geometry(const GeometryCheckOptions& options) {
  const std::optional<FileLength> unit = unit_of(options);
  options.step.require_step_among({options.file});
  if (has_point_cloud_extension(options.file) || has_points_only(options.file)) {
    PointCloudOptions reading;
    reading.unit = unit;
    return check_cloud(read_point_cloud(options.file, reading), options.json);
  }
  CheckedMesh mesh;
  mesh.file = options.step.read(options.file, unit);
  mesh.check = check_mesh(mesh.file.mesh);
  mesh.repeated = repeated_points(mesh.file.mesh.vertices);
  if (options.json) {
    fmt::print("{}", json_text(mesh_json(mesh)));
  } else {
    print_mesh(mesh);
  }
  return mesh.is_sound() ? kDone : kNegative;
}

}  // namespace abbe
