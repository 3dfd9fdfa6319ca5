// PCD files: any bytes give as many finite points as are stated, less those that are left out, or an InputError.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "abbe/formats/shapes/pcd_file.h"
#include "abbe/formats/shapes/pcd_header.h"
#include "abbe/formats/text/input_error.h"
#include "fuzz_cloud_blocks.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view contents(reinterpret_cast<const char*>(data), size);
  require_same_in_blocks(contents, "fuzz.pcd", true);
  try {
    const abbe::PointCloudFile read = abbe::parse_pcd(contents, "fuzz.pcd");
    const abbe::PointCloud& cloud = read.cloud;
    if (!cloud.points.allFinite() || !cloud.normals.allFinite()) std::abort();
    if (cloud.normals.cols() != 0 && cloud.normals.cols() != cloud.points.cols()) std::abort();
    const std::uint64_t stated = abbe::parse_pcd_header(contents, "fuzz.pcd").points;
    if (static_cast<std::uint64_t>(cloud.size()) + read.left_out != stated) std::abort();
  } catch (const abbe::InputError&) {
  }
  return 0;
}
