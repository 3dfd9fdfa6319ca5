#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/formats/text/file_unit.h"
#include "abbe/geometry/surface/triangle_mesh.h"

namespace abbe {

/// How the faces of a STEP file become triangles.
struct StepOptions {
  /// Largest distance between triangles and faces: measured, not only asked for. Without one 0.01 mm; under 10 mm a
  /// thousandth of the size of the part, over 100 mm a ten-thousandth, at most 0.1 mm (for parts up to 1 km).
  std::optional<double> chord_mm{};
  double angle_rad = 0.17453292519943;  ///< between neighbouring pieces of a curve or of a face, about
  double most_seconds = 60;             ///< for a file, a third of it for one face
  bool leave_out_faces = false;         ///< go on without faces that cannot be read; else they refuse the file
  /// Called while it takes long, by the calling thread, such as with "dividing faces", 20, 375.
  std::function<void(const std::string& what, std::size_t done, std::size_t total)> progress{};
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
  double deviation_mm = 0;                        ///< STEP: largest distance measured between triangles and faces
  /// STEP: faces that are missing with the reason, such as "#78 (cone about (0, 0, 5) mm) could not be converted".
  std::vector<std::string> left_out{};
  std::optional<double> left_out_share{};  ///< their part of the area, where that is known
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
