// OBJ files: any bytes give points and triangles that hold together, or an InputError.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "abbe/formats/shapes/obj_file.h"
#include "abbe/formats/text/input_error.h"
#include "fuzz_geometry.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view contents(reinterpret_cast<const char*>(data), size);
  try {
    const abbe::ObjContents read = abbe::parse_obj(contents, "fuzz.obj", {}, 1);
    require_sound(read.points, read.triangles);
    if (!read.region_of_triangle.empty() &&
        read.region_of_triangle.size() != static_cast<std::size_t>(read.triangles.cols())) {
      std::abort();
    }
    for (const std::uint32_t region : read.region_of_triangle) {
      if (region >= read.regions.size()) std::abort();
    }
  } catch (const abbe::InputError&) {
  }
  return 0;
}
