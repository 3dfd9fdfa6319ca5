// What abbe-step hands over: any bytes give a mesh that holds together, or an InputError. What was read is written
// again with the same bits.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "abbe/formats/shapes/step_mesh.h"
#include "abbe/formats/text/input_error.h"
#include "fuzz_geometry.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view contents(reinterpret_cast<const char*>(data), size);
  try {
    const abbe::StepMesh read = abbe::parse_step_mesh(contents, "fuzz.step");
    require_sound(read.mesh.vertices, read.mesh.triangles);
    if (read.face_of_triangle.size() != static_cast<std::size_t>(read.mesh.size())) std::abort();
    for (const std::uint32_t face : read.face_of_triangle) {
      if (face >= read.faces) std::abort();
    }
    const abbe::StepMesh again = abbe::parse_step_mesh(abbe::step_mesh_bytes(read), "fuzz.step");
    if (again.mesh.vertices != read.mesh.vertices || again.mesh.triangles != read.mesh.triangles ||
        again.face_of_triangle != read.face_of_triangle) {
      std::abort();
    }
  } catch (const abbe::InputError&) {
  }
  return 0;
}
