#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace abbe {

/// Processes that make the same computation in step. In every pass each one computes its own part, and gives the others
/// what they need of it. This shares passes that are too short for NumberedWork, and lets a process keep what it has
/// computed of an item.
struct WorkInStep {
  /// Adds what the following processes give to what those before them gave. It is associative to the last bit: who
  /// merges what with what first depends on the number of processes.
  using Merge = std::function<void(std::vector<std::byte>& all, std::span<const std::byte> following)>;

  std::size_t processes = 1, rank = 0;
  /// Gives the others bytes, and returns what merging those of all has made. Every process calls it at the same points
  /// of the computation. One process alone does not use it.
  /// @param fingerprint  of everything that the computation depends on; processes whose fingerprints differ fail
  std::function<std::vector<std::byte>(std::uint64_t fingerprint, std::vector<std::byte> own, const Merge& merge)>
      merged{};
};

}  // namespace abbe
