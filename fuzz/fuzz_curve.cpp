// Curves for tool paths, as CSV or as program: any bytes give a curve with finite numbers or an InputError.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "abbe/formats/shapes/curve_file.h"
#include "abbe/formats/text/input_error.h"
#include "fuzz_machine_data.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  static const abbe::Machine machine = fuzz_machine();
  const std::string_view text(reinterpret_cast<const char*>(data) + 1, size - 1);
  try {
    const abbe::Curve curve = data[0] % 2 == 0 ? abbe::parse_curve(text, "fuzz.csv", machine)
                                               : abbe::parse_curve_program(text, "fuzz.ngc", machine);
    for (const abbe::CurvePoint& point : curve.points) {
      if (!point.point.allFinite() || std::abs(point.direction.norm() - 1) > 1e-12) std::abort();
      if (point.indexed.size() != curve.indexed.size()) std::abort();
    }
  } catch (const abbe::InputError&) {
  }
  return 0;
}
