#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace abbe {

/// Processes that do the same computation at the same time. Of every pass each one computes its own part, and gives the
/// others what they need of it. So short passes can be shared, of which NumberedWork would cost more than it brings,
/// and what a process has computed of an item can stay there.
struct WorkInStep {
  std::size_t processes = 1, rank = 0;
  /// Gives the others bytes, and returns those of all, in the order of processes. Every process calls it at the same
  /// points of the computation. Not used where there is one process.
  /// @param fingerprint  of everything that the computation depends on; processes whose fingerprints differ fail
  std::function<std::vector<std::vector<std::byte>>(std::uint64_t fingerprint, std::span<const std::byte> own)>
      gather{};
};

}  // namespace abbe
