#pragma once

// Internal to formats: files compressed by gzip (RFC 1952).
#include <cstddef>
#include <string>
#include <string_view>

namespace abbe {

bool is_gzip(std::string_view bytes);

/// The contents of one gzip file, of all its members. @param largest  bytes
/// @throws InputError for a file that is damaged or cut short, and for contents larger than that
std::string unpacked_gzip(std::string_view bytes, const std::string& file, std::size_t largest);

}  // namespace abbe
