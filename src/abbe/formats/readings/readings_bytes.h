#pragma once

// Internal to formats: readings as bytes that another process takes.
#include <cstddef>
#include <span>
#include <vector>

#include "abbe/instruments/instrument.h"

namespace abbe {

/// Appends readings of a set-up that does not drift, in native byte order.
void pack_readings(const InstrumentReadings& readings, std::vector<std::byte>& bytes);

/// Takes what pack_readings() has appended off the front. @throws WorkError if it is cut off
InstrumentReadings unpack_readings(std::span<const std::byte>& bytes);

}  // namespace abbe
