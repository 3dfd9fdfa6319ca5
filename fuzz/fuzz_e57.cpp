// E57 files: any bytes give finite points, or an InputError. Checksums would stop nearly every change at once, so they
// are put right before the file is read a second time.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "abbe/formats/shapes/e57_file.h"
#include "abbe/formats/shapes/e57_for_test.h"
#include "abbe/formats/text/input_error.h"

namespace {

void read(std::string_view contents) {
  try {
    const abbe::PointCloudFile file = abbe::parse_e57(contents, "fuzz.e57", {}, 1);
    const abbe::PointCloud& cloud = file.cloud;
    if (!cloud.points.allFinite() || !cloud.normals.allFinite() || cloud.size() == 0) std::abort();
    if (cloud.normals.cols() != 0 && cloud.normals.cols() != cloud.points.cols()) std::abort();
  } catch (const abbe::InputError&) {
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string contents(reinterpret_cast<const char*>(data), size);
  read(contents);
  if (size > 48) read(abbe::e57_repaired_for_test(contents));
  return 0;
}
