// Point clouds, XYZ and CSV: any bytes give finite points or an InputError; points written as CSV read back the same.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "abbe/formats/shapes/point_cloud_file.h"
#include "abbe/formats/text/input_error.h"
#include "fuzz_cloud_blocks.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view contents(reinterpret_cast<const char*>(data), size);
  abbe::PointCloudOptions options;
  options.threads = 1;
  for (const char* file : {"fuzz.xyz", "fuzz.csv"}) {
    require_same_in_blocks(contents, file, false);
    abbe::PointCloudFile read;
    try {
      read = abbe::parse_point_cloud(contents, file, options);
    } catch (const abbe::InputError&) {
      continue;
    }
    if (!read.cloud.points.allFinite() || !read.cloud.normals.allFinite()) std::abort();
    const abbe::PointCloudFile back =
        abbe::parse_point_cloud(abbe::point_cloud_csv(read.cloud), "written.csv", options);
    if (back.cloud.points != read.cloud.points) std::abort();
  }
  return 0;
}
