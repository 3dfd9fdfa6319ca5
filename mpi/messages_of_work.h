#pragma once

#include <cstdint>
#include <cstring>
#include <vector>

#include "abbe/geometry/numbered_work.h"

namespace abbe {

/// A worker asks for blocks, and says which work it does.
struct BlockQuestion {
  std::uint64_t number;       ///< of the work in its command, from 1
  std::uint64_t fingerprint;  ///< of the work
  std::uint64_t blocks;       ///< of the whole work
  std::uint64_t wanted;       ///< how many to be handed out
  std::uint64_t threads;      ///< that compute blocks
};

inline void put_number(std::uint64_t number, std::vector<std::byte>& bytes) {
  const auto* const first = reinterpret_cast<const std::byte*>(&number);
  bytes.insert(bytes.end(), first, first + sizeof(number));
}

/// Takes a number off the front. @throws WorkError if there is none
inline std::uint64_t take_number(std::span<const std::byte>& bytes) {
  std::uint64_t number = 0;
  if (bytes.size() < sizeof(number)) throw WorkError("a message of a process is cut off");
  std::memcpy(&number, bytes.data(), sizeof(number));
  bytes = bytes.subspan(sizeof(number));
  return number;
}

/// Appends bytes with their number in front.
inline void put_bytes(std::span<const std::byte> added, std::vector<std::byte>& bytes) {
  put_number(added.size(), bytes);
  bytes.insert(bytes.end(), added.begin(), added.end());
}

/// Takes such bytes off the front. @throws WorkError if they are cut off
inline std::span<const std::byte> take_bytes(std::span<const std::byte>& bytes) {
  const std::uint64_t size = take_number(bytes);
  if (size > bytes.size()) throw WorkError("a message of a process is cut off");
  const std::span<const std::byte> taken = bytes.first(size);
  bytes = bytes.subspan(size);
  return taken;
}

/// Appends a block with its results.
inline void put_block(const NumberedWork& work, std::size_t block, std::vector<std::byte>& bytes) {
  put_number(block, bytes);
  const std::size_t at = bytes.size();
  put_number(0, bytes);
  work.pack(block, bytes);
  const std::uint64_t size = bytes.size() - at - sizeof(size);
  std::memcpy(&bytes[at], &size, sizeof(size));
}

/// Takes all blocks of a message: take(block, results).
template <typename Take>
void take_blocks(std::span<const std::byte> bytes, const Take& take) {
  while (!bytes.empty()) {
    const std::uint64_t block = take_number(bytes);
    take(static_cast<std::size_t>(block), take_bytes(bytes));
  }
}

}  // namespace abbe
