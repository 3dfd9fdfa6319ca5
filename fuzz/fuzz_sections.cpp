// Cross-sections for `abbe evaluate contour`: any bytes give sections with finite points or an InputError, and every
// section an answer or a reason.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "abbe/formats/evaluations/section_file.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/verify/parts/edge_section.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  try {
    for (const abbe::SectionReadings& section : abbe::parse_sections(text, "fuzz.csv")) {
      if (!section.points.allFinite()) std::abort();
      if (section.points.cols() > 500) continue;  // long sections would make the fuzzer slow
      const abbe::EdgeFit fit = abbe::fit_edge(section.points);
      if (fit.status != abbe::EdgeStatus::ok && fit.reason.empty()) std::abort();
      if (fit.status == abbe::EdgeStatus::ok && !(fit.corner.allFinite() && std::isfinite(fit.radius))) std::abort();
    }
  } catch (const abbe::InputError&) {
  }
  return 0;
}
