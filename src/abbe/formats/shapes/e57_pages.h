#pragma once

// Internal to formats: an E57 file is pages of 1024 bytes, of which the last four are a checksum. Without these, the
// others are the logical bytes of the file.
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>

namespace abbe {

inline constexpr std::size_t kE57PageBytes = 1024;
inline constexpr std::size_t kE57PageData = 1020;
inline constexpr std::size_t kE57HeaderBytes = 48;

class E57Pages {
 public:
  /// Checks the header and the checksum of every page. The contents have to outlive it.
  /// @param threads  0: all
  /// @throws InputError
  E57Pages(std::string_view contents, const std::string& file, int threads);

  /// Number of logical bytes.
  std::uint64_t size() const { return std::uint64_t{contents_.size()} / kE57PageBytes * kE57PageData; }
  /// Logical place of a byte of the file; none for a checksum or after the end.
  std::optional<std::uint64_t> logical(std::uint64_t physical) const;
  /// Byte of the file at a logical place, for messages.
  static std::uint64_t physical(std::uint64_t logical) {
    return logical / kE57PageData * kE57PageBytes + logical % kE57PageData;
  }
  /// Copies logical bytes, all of which must be there.
  void copy(std::uint64_t begin, std::size_t count, char* out) const;
  /// A number at a logical place.
  template <typename Number>
  Number number(std::uint64_t at) const {
    Number value;
    char bytes[sizeof(Number)];
    copy(at, sizeof(Number), bytes);
    std::memcpy(&value, bytes, sizeof(Number));
    return value;
  }
  /// The XML section.
  std::string xml() const;

 private:
  std::string_view contents_;
  std::uint64_t xml_begin_ = 0;
  std::uint64_t xml_size_ = 0;
};

}  // namespace abbe
