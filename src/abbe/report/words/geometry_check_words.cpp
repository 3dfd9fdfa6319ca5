#include "abbe/report/words/geometry_check_words.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "abbe/formats/text/vector_json.h"
#include "abbe/report/words/geometry_facts.h"

namespace abbe {
namespace {

using Json = nlohmann::ordered_json;

std::string coordinates(const Eigen::Vector3d& v) {
  return fmt::format("({:.9g}, {:.9g}, {:.9g})", v.x(), v.y(), v.z());
}

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

std::string mesh_verdict(const CheckedMesh& mesh) {
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

std::string box_text(const Eigen::Vector3d& lower, const Eigen::Vector3d& upper) {
  std::string text;
  text += fmt::format("{:<22} {} to {} mm\n", "box", coordinates(lower), coordinates(upper));
  text += fmt::format("{:<22} {} mm\n", "size", coordinates(upper - lower));
  return text;
}

}  // namespace

std::string mesh_text(const CheckedMesh& mesh) {
  std::string text;
  const MeshCheck& check = mesh.check;
  text += fmt::format("mesh, {}; unit of the file: {}\n\n", mesh.file.format, unit_words(mesh.file.unit));
  const auto line = [&text](const char* name, std::size_t count, const char* remark = "") {
    text += fmt::format("{:<22} {}{}\n", name, count, count > 0 ? remark : "");
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
  text += box_text(check.lower, check.upper);
  text += fmt::format("{:<22} {:.9g} mm2\n", "area", check.area);
  if (check.encloses_volume()) text += fmt::format("{:<22} {:.9g} mm3\n", "volume", check.volume);
  if (mesh.file.has_exact_faces())
    text += fmt::format("{:<22} {:.3g} mm of the exact faces\n", "triangles within", mesh.file.deviation_mm);
  text += fmt::format("\n{}\n", mesh_verdict(mesh));
  for (const std::string& note : mesh.file.notes) text += fmt::format("note: {}\n", note);
  return text;
}

nlohmann::ordered_json mesh_json(const CheckedMesh& mesh) {
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
  json["verdict"] = mesh_verdict(mesh);
  json["notes"] = mesh.file.notes;
  return json;
}

std::string cloud_text(const CheckedCloud& checked) {
  std::string text =
      fmt::format("point cloud, {}; unit of the file: {}\n\n", checked.file.format, unit_words(checked.file.unit));
  text += fmt::format("{:<22} {}\n", "points", checked.file.cloud.size());
  text += fmt::format("{:<22} {}{}\n", "repeated points", checked.repeated,
                      checked.repeated > 0 ? "  (at the place of another one)" : "");
  text += fmt::format("{:<22} {}\n", "normals", checked.file.cloud.has_normals() ? "yes" : "no");
  text += box_text(checked.lower, checked.upper);
  text += fmt::format("{:<22} {} mm\n", "centroid", coordinates(checked.centroid));
  for (const std::string& note : checked.file.notes) text += fmt::format("note: {}\n", note);
  return text;
}

nlohmann::ordered_json cloud_json(const CheckedCloud& checked) {
  Json json = head_json("point_cloud", checked.file.format, checked.file.unit);
  json["points"] = checked.file.cloud.size();
  json["points_left_out"] = checked.file.left_out;
  json["repeated_points"] = checked.repeated;
  json["normals"] = checked.file.cloud.has_normals();
  json["deviations"] = !checked.file.deviation_mm.empty();
  json["lower_mm"] = vector_json(checked.lower);
  json["upper_mm"] = vector_json(checked.upper);
  json["centroid_mm"] = vector_json(checked.centroid);
  json["notes"] = checked.file.notes;
  return json;
}

}  // namespace abbe
