// STL files: any bytes give points and triangles that hold together, or an InputError.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "abbe/formats/shapes/stl_file.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/geometry/surface/mesh_check.h"
#include "fuzz_geometry.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view contents(reinterpret_cast<const char*>(data), size);
  try {
    const abbe::MeshFile read = abbe::parse_stl(contents, "fuzz.stl");
    require_sound(read.mesh.vertices, read.mesh.triangles);
    const abbe::MeshFile back = abbe::parse_stl(abbe::stl_bytes(read.mesh), "written.stl");
    if (back.mesh.size() != read.mesh.size()) std::abort();
    abbe::check_mesh(read.mesh);
  } catch (const abbe::InputError&) {
  }
  return 0;
}
