// Readings for `abbe evaluate`: any bytes give readings or an InputError, for every kind; what was read is finite and
// can be evaluated.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "abbe/formats/evaluation_positioning.h"
#include "abbe/formats/input_error.h"

namespace {

void require_finite(const std::vector<abbe::PositioningReading>& readings) {
  for (const abbe::PositioningReading& reading : readings) {
    if (!std::isfinite(reading.target) || !std::isfinite(reading.deviation)) std::abort();
  }
}

void positioning(std::string_view text) {
  const abbe::PositioningFile file = abbe::parse_positioning(text, "fuzz.csv");
  require_finite(file.readings);
  const abbe::PositioningEvaluation result = abbe::evaluate_positioning(file.readings);
  if (result.accuracy.figure.is_evaluated() && !(result.accuracy.figure.value >= result.systematic.figure.value)) {
    std::abort();
  }
}

void diagonals(std::string_view text) {
  const auto all = abbe::parse_diagonals(text, "fuzz.csv");
  for (const abbe::DiagonalReadings& diagonal : all) require_finite(diagonal.readings);
  if (abbe::evaluate_diagonals(all).diagonals.size() != all.size()) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  // One line for every kind of evaluation.
  for (const auto read : {positioning, diagonals}) {
    try {
      read(text);
    } catch (const abbe::InputError&) {
    }
  }
  return 0;
}
