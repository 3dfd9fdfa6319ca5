#include "abbe/formats/shapes/mesh_file.h"

#include <fmt/format.h>

#include "abbe/formats/files/file_extension.h"
#include "abbe/formats/files/results_folder.h"
#include "abbe/formats/files/standard_input.h"
#include "abbe/formats/files/text_file.h"
#include "abbe/formats/import/readable_table.h"
#include "abbe/formats/shapes/ending.h"
#include "abbe/formats/shapes/obj_file.h"
#include "abbe/formats/shapes/ply_file.h"
#include "abbe/formats/shapes/step_file.h"
#include "abbe/formats/shapes/stl_file.h"
#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

constexpr const char* kFormats = "a mesh: STL, PLY, OBJ or STEP";

bool is_step_extension(const std::string& extension) { return extension == ".step" || extension == ".stp"; }

[[noreturn]] void refuse_no_faces(const std::string& file) {
  throw InputError({file, 0, 0, ""}, "there are no faces in the file", kFormats);
}

MeshFile mesh_of_ply(std::string_view contents, const std::string& file, const MeshFileOptions& options) {
  PlyContents ply = parse_ply(contents, file, options.unit);
  if (ply.triangles.cols() == 0) refuse_no_faces(file);
  MeshFile result;
  result.mesh = {std::move(ply.points), std::move(ply.triangles)};
  result.format = ply.format;
  result.unit = ply.unit;
  return result;
}

MeshFile mesh_of_obj(std::string_view contents, const std::string& file, const MeshFileOptions& options) {
  ObjContents obj = parse_obj(contents, file, options.unit, options.threads);
  if (obj.triangles.cols() == 0) refuse_no_faces(file);
  MeshFile result;
  result.mesh = {std::move(obj.points), std::move(obj.triangles)};
  result.format = "OBJ";
  result.unit = obj.unit;
  result.faces = obj.regions.size();
  result.face_of_triangle = std::move(obj.region_of_triangle);
  result.face_names = std::move(obj.regions);
  return result;
}

}  // namespace

MeshFile parse_mesh(std::string_view contents, const std::string& file, const MeshFileOptions& options) {
  const std::string extension = file_extension(without_gz(with_ending(file, contents)));
  if (is_step(contents)) {
    throw InputError({file, 0, 0, ""}, "a STEP file is read from the disk only", "STL, PLY or OBJ");
  }
  if (is_step_extension(extension)) {
    throw InputError({file, 1, 0, ""}, "this is not a STEP file", "a first line 'ISO-10303-21;'");
  }
  if (is_ply(contents)) return mesh_of_ply(contents, file, options);
  if (is_binary_stl(contents) || extension == ".stl") return parse_stl(contents, file, options);
  if (extension == ".obj") return mesh_of_obj(contents, file, options);
  if (extension == ".ply") throw InputError({file, 1, 0, ""}, "this is not a PLY file", "a first line 'ply'");
  if (is_ascii_stl(contents)) return parse_stl(contents, file, options);
  if (file == kStandardInput) refuse_contents(file, contents, "a mesh", {".stl", ".ply", ".obj", ".step"});
  throw InputError({file, 0, 0, ""}, fmt::format("files with the extension '{}' are not known", extension), kFormats);
}

MeshFile read_mesh(const std::filesystem::path& path, const MeshFileOptions& options) {
  const UnpackedFile file(path);
  if (is_step(file.text()) && !file.is_packed()) return read_step(path, options);
  return parse_mesh(file.text(), path.string(), options);
}

bool has_mesh_extension(const std::filesystem::path& path) {
  const std::string extension = file_extension(path);
  return extension == ".stl" || extension == ".ply" || extension == ".obj" || is_step_extension(extension);
}

void write_mesh(const std::filesystem::path& path, const TriangleMesh& mesh) {
  const std::string extension = file_extension(path);
  if (extension == ".stl") {
    write_file_atomically(path, stl_bytes(mesh));
  } else if (extension == ".ply") {
    PlyParts parts{mesh.vertices};
    parts.triangles = mesh.triangles;
    write_file_atomically(path, ply_bytes(parts));
  } else {
    throw InputError({path.string(), 0, 0, ""}, fmt::format("meshes are not written as '{}'", extension),
                     ".stl or .ply");
  }
}

}  // namespace abbe
