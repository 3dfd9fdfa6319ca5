// PLY files: any bytes give points and triangles that hold together, or an InputError.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "abbe/formats/shapes/ply_file.h"
#include "abbe/formats/text/input_error.h"
#include "fuzz_cloud_blocks.h"
#include "fuzz_geometry.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view contents(reinterpret_cast<const char*>(data), size);
  require_same_in_blocks(contents, "fuzz.ply", true);
  abbe::PlyContents read;
  try {
    read = abbe::parse_ply(contents, "fuzz.ply");
  } catch (const abbe::InputError&) {
    return 0;
  }
  require_sound(read.points, read.triangles);
  // Written and read again, it is the same.
  abbe::PlyParts parts{read.points};
  parts.normals = read.normals;
  parts.triangles = read.triangles;
  const abbe::PlyContents back = abbe::parse_ply(abbe::ply_bytes(parts), "written.ply");
  if (back.points != read.points || back.normals != read.normals || back.triangles != read.triangles) std::abort();
  return 0;
}
