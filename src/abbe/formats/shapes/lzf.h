#pragma once

// Internal to formats: data compressed by LZF, as PCD files have them.
#include <span>
#include <string_view>

namespace abbe {

/// At most this many bytes come of one compressed byte: a copy of 264 bytes takes three.
inline constexpr std::size_t kLzfLargestGrowth = 88;

/// Decompresses LZF data, which has to fill `out` exactly.
///
/// A control byte c below 32 is followed by c + 1 bytes as they are. Any other copies what was written before:
/// (c >> 5) + 2 bytes, or 9 and the next byte if c >> 5 is 7, from 1 + 256 (c & 31) + the last byte places back.
/// Source: M. Lehmann, LibLZF, http://oldhome.schmorp.de/marc/liblzf.html.
/// @returns false if the data are damaged or of another length
bool lzf_decompress(std::string_view compressed, std::span<char> out);

}  // namespace abbe
