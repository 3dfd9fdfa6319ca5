#include "abbe/study/verification/verification_condition.h"

#include <fmt/format.h>

#include <cmath>

#include "abbe/formats/text/input_error.h"

namespace abbe {

void require_condition(const char* option, std::optional<double> value) {
  if (!value || (*value > 0 && std::isfinite(*value))) return;
  throw InputError({.field = option}, fmt::format("{} is not a condition", *value), "a number above zero");
}

}  // namespace abbe
