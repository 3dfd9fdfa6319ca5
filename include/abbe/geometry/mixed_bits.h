#pragma once

#include <cstdint>

namespace abbe {

/// A number whose bits look random, from one that counts. Different numbers give different ones.
/// Source: SplitMix64 (G. Steele, D. Lea, C. Flood, OOPSLA 2014, 453).
constexpr std::uint64_t mixed_bits(std::uint64_t number) {
  std::uint64_t z = number + 0x9e3779b97f4a7c15U;
  z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
  z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
  return z ^ (z >> 31U);
}

}  // namespace abbe
