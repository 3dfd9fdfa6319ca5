// Transform files: any bytes give a rotation and a finite shift or an InputError; a transform reads back from its text.
#include <Eigen/LU>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "abbe/formats/machine/transform_file.h"
#include "abbe/formats/text/input_error.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view contents(reinterpret_cast<const char*>(data), size);
  abbe::RigidTransform read;
  try {
    read = abbe::parse_transform(contents, "fuzz.csv");
  } catch (const abbe::InputError&) {
    return 0;
  }
  if (!read.translation.allFinite() || !(read.rotation.determinant() > 0.999)) std::abort();
  const abbe::RigidTransform back = abbe::parse_transform(abbe::transform_csv(read), "written.csv");
  if (back.rotation != read.rotation || back.translation != read.translation) std::abort();
  return 0;
}
