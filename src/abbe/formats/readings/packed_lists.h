#pragma once

// Internal to formats: lists as bytes of numbered work, in native byte order.
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "abbe/geometry/numbered_work.h"

namespace abbe {

inline void pack_length(std::size_t length, std::vector<std::byte>& bytes) {
  const std::uint64_t number = length;
  const auto own = std::as_bytes(std::span(&number, 1));
  bytes.insert(bytes.end(), own.begin(), own.end());
}

/// Takes a length off the front.
/// @param each  bytes that an entry takes at least
/// @throws WorkError if so many entries cannot follow
inline std::size_t unpack_length(std::span<const std::byte>& bytes, std::size_t each) {
  std::uint64_t number = 0;
  if (bytes.size() < sizeof(number)) throw WorkError("a list is cut off");
  std::memcpy(&number, bytes.data(), sizeof(number));
  bytes = bytes.subspan(sizeof(number));
  if (number > bytes.size() / each) throw WorkError("a list is cut off");
  return static_cast<std::size_t>(number);
}

/// Appends the length of a list and its values, numbers or characters.
/// @param list  vector or string
template <class List>
void pack_list(const List& list, std::vector<std::byte>& bytes) {
  static_assert(std::is_arithmetic_v<typename List::value_type>);
  pack_length(list.size(), bytes);
  const auto own = std::as_bytes(std::span(list));
  bytes.insert(bytes.end(), own.begin(), own.end());
}

/// Takes what pack_list() has appended off the front. @throws WorkError if it is cut off
template <class List>
void unpack_list(std::span<const std::byte>& bytes, List& list) {
  using Value = typename List::value_type;
  static_assert(std::is_arithmetic_v<Value>);
  list.resize(unpack_length(bytes, sizeof(Value)));
  const std::size_t size = list.size() * sizeof(Value);
  if (size > 0) std::memcpy(list.data(), bytes.data(), size);
  bytes = bytes.subspan(size);
}

}  // namespace abbe
