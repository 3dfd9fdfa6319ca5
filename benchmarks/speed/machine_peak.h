#pragma once

// What the processor and its memory can do at most, measured in the program that compares with it.

#include <cstddef>

namespace abbe::benchmarks {

/// Multiplications and additions of doubles per second: fused where the processor can, vectors as wide as kernels that
/// choose their instructions at run time use them, everything in registers.
double peak_operations(int threads);

/// Bytes per second between memory and processor: a = b + s c over arrays that no cache holds, 24 bytes each.
double memory_bandwidth(int threads);

/// Bytes per second written by one thread, again and again, to so many bytes.
double store_bandwidth(std::size_t bytes);

}  // namespace abbe::benchmarks
