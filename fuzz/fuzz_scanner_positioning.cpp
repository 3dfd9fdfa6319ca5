// Scans for `abbe position`: a TOML file and the CSV that it names, divided by the first NUL; any bytes give finite
// points or an InputError.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "abbe/formats/readings/scanner_positioning_file.h"
#include "abbe/formats/text/input_error.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view all(reinterpret_cast<const char*>(data), size);
  const std::size_t end = all.find('\0');
  const std::string_view points = end == std::string_view::npos ? std::string_view() : all.substr(end + 1);
  try {
    const abbe::ScannerPositioningFile file =
        abbe::parse_scanner_positioning(std::string(all.substr(0, end)), "fuzz.positioning.toml", points, "fuzz.csv");
    for (const Eigen::Vector3d& p : file.scans.along_x) {
      if (!p.allFinite()) std::abort();
    }
    if (file.workpiece && !file.workpiece->points.allFinite()) std::abort();
    if (file.workpiece && file.workpiece->labels.size() != static_cast<std::size_t>(file.workpiece->points.cols())) {
      std::abort();
    }
  } catch (const abbe::InputError&) {
  }
  return 0;
}
