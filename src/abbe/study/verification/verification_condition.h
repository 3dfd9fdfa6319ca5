#pragma once

// Internal to study: figures that a verification may be asked for.
#include <optional>

namespace abbe {

/// Refuses a condition that nothing meets, or everything.
/// @param option  of `abbe verify`, for messages
/// @throws InputError for numbers that are not above zero
void require_condition(const char* option, std::optional<double> value);

}  // namespace abbe
