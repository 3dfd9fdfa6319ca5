#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "abbe/geometry/digest.h"
#include "abbe/identify/sums/sum_request.h"

namespace abbe {

/// Writes numbers as bytes, little-endian. Lists and texts have their length before them.
class ByteWriter {
 public:
  void put(std::uint64_t value) {
    const std::size_t at = bytes_.size();
    bytes_.resize(at + 8);
    for (std::size_t i = 0; i < 8; ++i) bytes_[at + i] = static_cast<std::byte>(value >> (8 * i));
  }
  void put(double value) { put(std::bit_cast<std::uint64_t>(value)); }
  void put(const std::string& text) {
    put(std::uint64_t{text.size()});
    for (const char c : text) bytes_.push_back(static_cast<std::byte>(c));
  }
  void put(const std::vector<std::uint8_t>& list) {
    put(std::uint64_t{list.size()});
    for (const std::uint8_t value : list) bytes_.push_back(static_cast<std::byte>(value));
  }
  void put(const std::vector<std::uint64_t>& list) {
    put(std::uint64_t{list.size()});
    for (const std::uint64_t value : list) put(value);
  }
  void put(const std::vector<double>& list) {
    put(std::uint64_t{list.size()});
    bytes_.reserve(bytes_.size() + 8 * list.size());
    for (const double value : list) put(value);
  }

  /// The bytes with their check sum behind them.
  std::vector<std::byte> finish() {
    put(digest());
    return std::move(bytes_);
  }
  std::uint64_t digest() const {
    Digest digest;
    digest.add_bytes(bytes_);
    return digest.value();
  }

 private:
  std::vector<std::byte> bytes_;
};

/// Reads what ByteWriter has written.
class ByteReader {
 public:
  /// @param format  name and version that come first
  /// @throws SumError
  ByteReader(std::span<const std::byte> bytes, const std::string& format, std::uint64_t version)
      : bytes_(bytes), format_(format) {
    const std::string found = text();
    if (found != format) fail("does not begin as one");
    const std::uint64_t written = number();
    if (written != version)
      fail("is of version " + std::to_string(written) + ", and this program reads version " + std::to_string(version));
    if (bytes.size() < at_ + 8) fail("is cut off");
    bytes_ = bytes.first(bytes.size() - 8);
    Digest digest;
    digest.add_bytes(bytes_);
    if (number_at(bytes, bytes_.size()) != digest.value()) fail("is damaged: its check sum does not fit");
  }

  std::uint64_t number() {
    if (bytes_.size() - at_ < 8) fail("is cut off");
    at_ += 8;
    return number_at(bytes_, at_ - 8);
  }
  double real() { return std::bit_cast<double>(number()); }
  std::string text() {
    std::string result(length(1), ' ');
    for (char& c : result) c = static_cast<char>(bytes_[at_++]);
    return result;
  }
  std::vector<std::uint8_t> small_numbers() {
    std::vector<std::uint8_t> result(length(1));
    for (std::uint8_t& value : result) value = static_cast<std::uint8_t>(bytes_[at_++]);
    return result;
  }
  std::vector<std::uint64_t> numbers() {
    std::vector<std::uint64_t> result(length(8));
    for (std::uint64_t& value : result) value = number();
    return result;
  }
  std::vector<double> reals() {
    std::vector<double> result(length(8));
    for (double& value : result) value = real();
    return result;
  }
  /// Length of a list whose entries take at least `bytes` each.
  std::size_t length(std::size_t bytes) {
    const std::uint64_t count = number();
    if (count > (bytes_.size() - at_) / bytes) fail("is cut off");
    return static_cast<std::size_t>(count);
  }
  /// A number of 0 .. last.
  std::uint64_t number_up_to(std::uint64_t last) {
    const std::uint64_t value = number();
    if (value > last) fail("holds a number that it cannot hold");
    return value;
  }
  void end() const {
    if (at_ != bytes_.size()) fail("is longer than what it holds");
  }
  [[noreturn]] void fail(const std::string& what) const { throw SumError("this " + format_ + " " + what); }

 private:
  static std::uint64_t number_at(std::span<const std::byte> bytes, std::size_t at) {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < 8; ++i) value |= static_cast<std::uint64_t>(bytes[at + i]) << (8 * i);
    return value;
  }

  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
  std::string format_;
};

}  // namespace abbe
