#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "abbe/verify/error_map.h"

namespace abbe {

/// Fingerprint of everything that the deviations of a map depend on.
std::uint64_t map_fingerprint(const Machine& machine, const ErrorSet& actual, const ErrorSet* reference,
                              const PoseSource& poses, const ErrorMapOptions& options);

/// The results of a block of poses as bytes, without norms and whether poses are covered, which visit_map() has.
struct MapBytes {
  std::function<void(std::size_t first, std::size_t count, std::vector<std::byte>& bytes)> pack{};
  std::function<void(std::size_t first, std::size_t count, std::span<const std::byte>& bytes)> unpack{};
  ErrorMap* map = nullptr;  ///< gets norms and which poses are covered, when all is done
};

/// @param map  with its arrays, besides these two, in their sizes
MapBytes bytes_of(ErrorMap& map);

}  // namespace abbe
