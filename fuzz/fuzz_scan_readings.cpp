// Readings of a scan on a fixed machine: any bytes give points or an InputError; both formats hold as many points as
// are counted, and the points are finite and within the box that is stated.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>
#include <string_view>

#include "abbe/formats/readings/scan_file.h"
#include "abbe/formats/text/input_error.h"
#include "fuzz_machine_data.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const abbe::Machine machine = fuzz_machine();
  static const abbe::PointScan scan(machine, {}, {});
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  for (const bool mapped : {true, false}) {
    abbe::ScanOptions options;
    options.threads = 1;
    if (mapped) {
      options.mapping.columns = {{"X_mm", "x"}, {"indication_um", "h"}};
      options.mapping.ignore = {"remark"};
      options.check_travel = false;
      options.lowest_indication = -0.2;
      options.highest_indication = 0.2;
    }
    std::array<abbe::ScanSummary, 2> summary;
    std::array<std::string, 2> written;
    bool refused = false;
    for (const abbe::ScanFormat format : {abbe::ScanFormat::csv, abbe::ScanFormat::ply}) {
      const auto which = static_cast<std::size_t>(format);
      try {
        summary[which] = abbe::scan_points(text, "fuzz.csv", machine, scan, format, options,
                                           [&](std::string_view piece) { written[which] += piece; });
      } catch (const abbe::InputError&) {
        refused = true;
      }
    }
    if (refused) continue;
    const std::size_t points = summary[0].points;
    std::size_t lines = 0;
    for (const char c : written[0]) lines += c == '\n' ? 1U : 0U;
    if (points != summary[1].points || lines != points + 1 || written[1].size() != 24 * points) std::abort();
    if (summary[0].readings != points + summary[0].out_of_range + summary[0].not_covered) std::abort();
    const char* at = written[0].c_str() + written[0].find('\n') + 1;
    for (std::size_t i = 0; i < 3 * points; ++i) {
      double value = 0;
      std::memcpy(&value, written[1].data() + 8 * i, sizeof(value));
      const auto k = static_cast<Eigen::Index>(i % 3);
      if (!std::isfinite(value) || value < summary[1].lowest[k] || value > summary[1].highest[k]) std::abort();
      // The text is that number, rounded to a picometre.
      char* end = nullptr;
      const double in_text = std::strtod(at, &end);
      if (end == at || *end != (i % 3 == 2 ? '\n' : ',')) std::abort();
      if (std::abs(in_text - value) > 6e-10 + 1e-15 * std::abs(value)) std::abort();
      at = end + 1;
    }
  }
  return 0;
}
