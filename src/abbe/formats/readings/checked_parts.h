#pragma once

// Internal to formats: what is found in some parts of the files of a set-up when they are checked.
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "abbe/formats/readings/outermost_readings.h"

namespace abbe {

struct CheckedParts {
  std::vector<std::uint64_t> fingerprints;  ///< [parts]
  OutermostReadings outermost;
  /// Readings that are drawn, and those that are outermost in their part.
  InstrumentReadings kept;
  std::vector<std::uint64_t> numbers;  ///< of these among all readings

  /// Keeps some readings of a part.
  /// @param first  number of its first reading among all
  /// @param at     their places in the part
  void keep(const InstrumentReadings& part, std::size_t first, const std::vector<std::size_t>& at);

  void pack(std::vector<std::byte>& bytes) const;
  /// @param count  of parts. @throws WorkError if the bytes are not those of so many
  static CheckedParts unpack(std::span<const std::byte> bytes, std::size_t count);
};

}  // namespace abbe
