#include "abbe/formats/shapes/e57_section.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <limits>

#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

constexpr std::size_t kSectionHeader = 32;
constexpr std::size_t kPacketHeader = 6;
constexpr std::uint64_t kLargestPacket = 65536;
constexpr std::uint8_t kPointSection = 1;
enum E57Packet : std::uint8_t { kIndexPacket = 0, kDataPacket = 1, kEmptyPacket = 2 };
constexpr std::uint8_t kRestarts = 1;

/// Bits that a byte stream may have after its last value: writers of integers fill a word of at most 64 bits up.
std::uint64_t most_left(const E57Field& field) {
  switch (field.kind) {
    case E57Field::Kind::integer:
      return 63;
    case E57Field::Kind::text:
      return std::numeric_limits<std::uint64_t>::max();
    default:
      return 0;
  }
}

/// Converts the values of one field as the pieces of its byte stream arrive.
class E57Values {
 public:
  E57Values(const E57Field& field, E57Section::Target target, std::uint64_t count)
      : field_(field), out_(target.first), stride_(target.stride), left_(count) {}

  bool is_wanted() const { return out_ != nullptr; }
  /// Room for the next piece of `size` bytes, after what is left of the one before.
  char* piece(std::size_t size) {
    held_ = waiting_ + size;
    // Behind the bytes a word is read that need not be there.
    if (bytes_.size() < held_ + 16) bytes_.resize(held_ + 16);
    return bytes_.data() + waiting_;
  }
  /// Converts what is there. @return false if a value is beyond the range of its field
  bool convert() {
    std::size_t at = 0;  // bytes that are used up
    bool good = true;
    if (field_.kind == E57Field::Kind::integer) {
      const std::uint64_t there = 8 * std::uint64_t{held_} - bit_;
      const std::uint64_t count = field_.bits == 0 ? left_ : std::min(left_, there / field_.bits);
      good = integers(count);
      const std::uint64_t used = bit_ + count * field_.bits;
      at = static_cast<std::size_t>(used / 8);
      bit_ = static_cast<unsigned>(used % 8);
    } else if (field_.kind == E57Field::Kind::single_precision) {
      at = floats<float>();
    } else {
      at = floats<double>();
    }
    waiting_ = held_ - at;
    std::memmove(bytes_.data(), bytes_.data() + at, waiting_);
    return good;
  }
  std::uint64_t left() const { return left_; }

 private:
  void put(double value) {
    *out_ = value;
    out_ += stride_;
  }

  template <typename Number>
  std::size_t floats() {
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(left_, held_ / sizeof(Number)));
    const char* from = bytes_.data();
    for (std::size_t i = 0; i < count; ++i, from += sizeof(Number)) {
      Number number;
      std::memcpy(&number, from, sizeof number);
      put(static_cast<double>(number));
    }
    left_ -= count;
    return count * sizeof(Number);
  }

  bool integers(std::uint64_t count) {
    const std::uint64_t mask = field_.bits == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << field_.bits) - 1;
    const auto least = static_cast<std::uint64_t>(field_.least);
    std::uint64_t place = bit_;
    bool good = true;
    for (std::uint64_t i = 0; i < count; ++i, place += field_.bits) {
      const char* const from = bytes_.data() + place / 8;
      const auto shift = static_cast<unsigned>(place % 8);
      std::uint64_t word = 0;
      std::memcpy(&word, from, 8);
      word >>= shift;
      if (shift + field_.bits > 64) {
        word |= std::uint64_t{static_cast<unsigned char>(from[8])} << (64 - shift);
      }
      word &= mask;
      good = good && word <= field_.range;
      put(static_cast<double>(static_cast<std::int64_t>(least + word)) * field_.scale + field_.offset);
    }
    left_ -= count;
    return good;
  }

  const E57Field& field_;
  double* out_;
  std::size_t stride_;
  std::uint64_t left_;
  std::vector<char> bytes_;
  std::size_t waiting_ = 0;  ///< bytes of the pieces before
  std::size_t held_ = 0;     ///< with the last piece
  unsigned bit_ = 0;         ///< of the first byte, where the next value begins
};

}  // namespace

E57Section::E57Section(const E57Pages& pages, const E57Scan& scan, const std::string& file)
    : pages_(pages), scan_(scan), file_(file) {
  const auto place = pages.logical(scan.section);
  if (!place || *place < kE57HeaderBytes || pages.size() - *place < kSectionHeader) {
    throw InputError({.file = file, .field = scan.name + " fileOffset"},
                     fmt::format("byte {} is not the start of a section", scan.section), "a place in the file");
  }
  begin_ = *place;
  if (pages.number<std::uint8_t>(begin_) != kPointSection) {
    fail(begin_, fmt::format("a section of kind {}", pages.number<std::uint8_t>(begin_)), "1, compressed vector");
  }
  const auto length = pages.number<std::uint64_t>(begin_ + 8);
  if (length < kSectionHeader || length > pages.size() - begin_) {
    fail(begin_ + 8, fmt::format("a section of {} bytes", length), "one that ends in the file");
  }
  end_ = begin_ + length;
  const auto first = pages.logical(pages.number<std::uint64_t>(begin_ + 16));
  if (!first || *first < begin_ + kSectionHeader || *first > end_) {
    fail(begin_ + 16, fmt::format("packets from byte {} on", pages.number<std::uint64_t>(begin_ + 16)),
         "a place in the section");
  }
  first_packet_ = *first;
}

void E57Section::find_packets() {
  std::vector<std::uint64_t> bytes(scan_.fields.size(), 0);
  for (std::uint64_t at = first_packet_; at < end_;) {
    const std::uint64_t packet = packet_length(at);
    if (pages_.number<std::uint8_t>(at) == kDataPacket) {
      std::uint64_t sum = kPacketHeader + 2 * bytes.size();
      for (std::size_t k = 0; k < bytes.size(); ++k) {
        const auto stream = pages_.number<std::uint16_t>(at + kPacketHeader + 2 * k);
        bytes[k] += stream;
        sum += stream;
      }
      if (sum > packet) fail(at, fmt::format("{} bytes of streams in a packet of {}", sum, packet), "not more");
      packets_.push_back(at);
    }
    at += packet;
  }
  require_values(bytes);
}

void E57Section::fail(std::uint64_t at, const std::string& problem, const std::string& expected) const {
  throw InputError({.file = file_, .field = scan_.name + " points"},
                   fmt::format("at byte {}: {}", E57Pages::physical(at), problem), expected);
}

/// Length of the packet at a place, after its header was checked.
std::uint64_t E57Section::packet_length(std::uint64_t at) const {
  if (end_ - at < kPacketHeader) fail(at, "the section ends", "a packet");
  const auto kind = pages_.number<std::uint8_t>(at);
  if (kind != kIndexPacket && kind != kDataPacket && kind != kEmptyPacket) {
    fail(at, fmt::format("a packet of kind {}", kind), "0, 1 or 2");
  }
  const std::uint64_t length = std::uint64_t{pages_.number<std::uint16_t>(at + 2)} + 1;
  if (length % 4 != 0 || length > end_ - at) {
    fail(at + 2, fmt::format("a packet of {} bytes", length),
         fmt::format("a multiple of 4 of at most {}", std::min(kLargestPacket, end_ - at)));
  }
  if (kind != kDataPacket) return length;
  const std::size_t streams = pages_.number<std::uint16_t>(at + 4);
  if (streams != scan_.fields.size()) {
    fail(at + 4, fmt::format("{} byte streams", streams), fmt::format("{}, one for each field", scan_.fields.size()));
  }
  if (kPacketHeader + 2 * streams > length) fail(at + 2, fmt::format("a packet of {} bytes", length), "more");
  if ((pages_.number<std::uint8_t>(at + 1) & kRestarts) != 0 && !packets_.empty()) {
    fail(at + 1, "the streams begin anew", "streams that continue through all packets, as known programs write them");
  }
  return length;
}

/// What the header promises must be there before memory is taken for it, and not more: then the number is wrong.
void E57Section::require_values(const std::vector<std::uint64_t>& bytes) const {
  const std::uint64_t points = scan_.points;
  for (std::size_t k = 0; k < bytes.size(); ++k) {
    const E57Field& field = scan_.fields[k];
    const std::uint64_t bits = 8 * bytes[k];
    const bool enough = field.bits == 0 || points <= bits / field.bits;
    if (enough && bits - points * field.bits <= most_left(field)) continue;
    throw InputError({.file = file_, .field = scan_.name + " recordCount"},
                     fmt::format("{} points are stated, but {} has {} bytes for them", points, field.name, bytes[k]),
                     fmt::format("{} bits for each", field.bits));
  }
}

void E57Section::read(const std::array<Target, kE57WantedCount>& targets) const {
  std::vector<E57Values> streams;
  for (std::size_t k = 0; k < scan_.fields.size(); ++k) {
    Target target;
    for (std::size_t slot = 0; slot < kE57WantedCount; ++slot) {
      if (scan_.wanted[slot] == k) target = targets[slot];
    }
    streams.emplace_back(scan_.fields[k], target, scan_.points);
  }
  const auto convert = [&](std::size_t k, std::uint64_t at) {
    if (streams[k].convert()) return;
    fail(at, fmt::format("a value of {} in this packet is beyond its maximum", scan_.fields[k].name),
         fmt::format("at most {} above the minimum", scan_.fields[k].range));
  };
  for (const std::uint64_t packet : packets_) {
    std::uint64_t at = packet + kPacketHeader + 2 * streams.size();
    for (std::size_t k = 0; k < streams.size(); ++k) {
      const auto size = pages_.number<std::uint16_t>(packet + kPacketHeader + 2 * k);
      if (streams[k].is_wanted()) {
        pages_.copy(at, size, streams[k].piece(size));
        convert(k, packet);
      }
      at += size;
    }
  }
  // Constants need no packet.
  for (std::size_t k = 0; k < streams.size(); ++k) {
    if (streams[k].is_wanted() && streams[k].left() > 0) {
      streams[k].piece(0);
      convert(k, end_);
    }
  }
}

}  // namespace abbe
