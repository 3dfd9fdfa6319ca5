#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/formats/file_unit.h"
#include "abbe/geometry/triangle_mesh.h"

namespace abbe {

/// How finely the faces of a STEP file become triangles.
struct StepOptions {
  double chord_mm = 0.01;               ///< largest distance between triangles and faces: measured, not only asked for
  double angle_rad = 0.17453292519943;  ///< between neighbouring pieces of a curve or of a face, about
  double most_seconds = 3600;  ///< after which OpenCASCADE is stopped; it stops itself after 600 s of processor time
};

struct MeshFileOptions {
  std::optional<FileLength> unit;  ///< of files that state none; without it mm, which the result says
  int threads = 0;                 ///< 0: all
  StepOptions step{};
};

/// A mesh as read, and what a reader of the result has to know about it.
struct MeshFile {
  TriangleMesh mesh;   ///< mm
  std::string format;  ///< "STL, binary", "PLY, ascii", "OBJ"
  FileUnit unit;
  std::vector<std::string> notes;  ///< sentences: "the normals of 12 facets contradict the order of their corners"

  // Of files with exact faces (STEP), or with objects, groups or materials (OBJ); empty for others.
  std::size_t faces = 0;
  std::vector<std::uint32_t> face_of_triangle{};  ///< [triangles] from 0, in the order of the file
  std::vector<std::string> face_names{};          ///< [faces] of OBJ: "object / group / material"; else empty
  double deviation_mm = 0;  ///< STEP: largest distance measured between triangles and faces, at most chord_mm
  bool has_exact_faces() const { return faces > 0 && face_names.empty(); }
};

/// Reads STL, PLY, OBJ or STEP; see docs/geometry-files.md. The contents decide, the extension where they cannot.
///
/// Every triangle of the file is kept in its order, also one without area; vertices of STL files are welded where their
/// coordinates are equal. Vertices of PLY and OBJ files are left as they are. All indices are in range, all coordinates
/// finite and at most 1e9 mm. Memory is bounded by a small multiple of the file's size, whatever its header promises.
/// @throws InputError with line or byte, field and what was expected
MeshFile read_mesh(const std::filesystem::path& path, const MeshFileOptions& options = {});

/// The same from the contents, but for STEP, which another program reads from the disk.
/// @param file  name for messages; its extension counts
MeshFile parse_mesh(std::string_view contents, const std::string& file, const MeshFileOptions& options = {});

/// True for the extensions of mesh files (.stl .ply .obj .step .stp, also in capitals).
bool has_mesh_extension(const std::filesystem::path& path);

/// Writes a mesh in mm, atomically: .stl (binary, coordinates rounded to float), .ply (binary, double). @throws
/// InputError for another extension or if it cannot be written
void write_mesh(const std::filesystem::path& path, const TriangleMesh& mesh);

}  // namespace abbe
