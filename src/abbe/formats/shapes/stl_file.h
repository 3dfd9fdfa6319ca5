#pragma once

#include <string>
#include <string_view>

#include "abbe/formats/shapes/mesh_file.h"

namespace abbe {

/// True if the contents can be a binary STL file: the number of triangles in it agrees with its length. That decides
/// before the word "solid", with which the header of a binary file may begin too.
bool is_binary_stl(std::string_view contents);
/// True if the contents begin like a binary STL file, of whatever length: header, number of triangles and, as far as it
/// is there, a facet with numbers that coordinates have.
bool begins_like_binary_stl(std::string_view contents);
/// True if the contents begin like an ascii STL file.
bool is_ascii_stl(std::string_view contents);

/// Reads STL, ascii or binary; see read_mesh(). Triangles turn as their corners are ordered; facet normals only serve
/// to note those that contradict. Colours and attributes are passed over. @throws InputError
MeshFile parse_stl(std::string_view contents, const std::string& file, const MeshFileOptions& options = {});

/// Binary STL of a mesh in mm; coordinates are rounded to float (1 part in 1.7e7).
std::string stl_bytes(const TriangleMesh& mesh);

}  // namespace abbe
