// Sums of deviations as bytes.
#include <cstring>
#include <stdexcept>
#include <type_traits>

#include "abbe/verify/parts/deviation_sums.h"

namespace abbe {
namespace {

template <class Value>
void append_value(const Value& value, std::string& bytes) {
  static_assert(std::is_trivially_copyable_v<Value>);
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

template <class Value>
Value take_value(std::string_view& bytes) {
  static_assert(std::is_trivially_copyable_v<Value>);
  if (bytes.size() < sizeof(Value)) throw std::invalid_argument("the state of the sums ends");
  Value value;
  std::memcpy(&value, bytes.data(), sizeof value);
  bytes.remove_prefix(sizeof value);
  return value;
}

constexpr unsigned kBitsOfByte = 7;
constexpr std::uint64_t kGoesOn = 0x80;

/// Seven bits in a byte, the lowest first: most numbers are small.
void append_number(std::uint64_t number, std::string& bytes) {
  for (; number >= kGoesOn; number >>= kBitsOfByte) bytes += static_cast<char>(number % kGoesOn + kGoesOn);
  bytes += static_cast<char>(number);
}

std::uint64_t take_number(std::string_view& bytes) {
  std::uint64_t number = 0;
  for (unsigned shift = 0; shift < 64; shift += kBitsOfByte) {
    const auto byte = static_cast<std::uint64_t>(take_value<unsigned char>(bytes));
    number |= byte % kGoesOn << shift;
    if (byte < kGoesOn) return number;
  }
  throw std::invalid_argument("a number of the state is too long");
}

struct PackedPoint {
  std::uint64_t number;
  double x, y, z, deviation_mm;
};

}  // namespace

std::string DeviationSums::state(const PointSample& known) const {
  std::string bytes;
  for (const std::uint64_t number : {points_, beyond_border_, too_far_}) append_number(number, bytes);
  append_value(all_, bytes);
  append_number(regions_.size(), bytes);
  for (const DeviationTotals& region : regions_) {
    append_number(region.count, bytes);
    if (region.count > 0) append_value(region, bytes);
  }
  const auto occupied = histogram_.occupied();
  append_number(occupied.size(), bytes);
  std::uint32_t before = 0;
  for (const auto& [number, count] : occupied) {
    append_number(number - before, bytes);
    append_number(count, bytes);
    before = number;
  }
  for (const SampledPoint& p : sample_.points()) {
    if (!known.keeps(p)) continue;
    append_value(PackedPoint{p.number, p.point.x(), p.point.y(), p.point.z(), p.deviation_mm}, bytes);
  }
  return bytes;
}

void DeviationSums::add_state(std::string_view state) {
  for (std::uint64_t* const number : {&points_, &beyond_border_, &too_far_}) *number += take_number(state);
  all_.add(take_value<DeviationTotals>(state));
  if (take_number(state) != regions_.size()) throw std::invalid_argument("the state has other regions");
  for (DeviationTotals& region : regions_) {
    if (take_number(state) > 0) region.add(take_value<DeviationTotals>(state));
  }
  std::uint64_t place = 0;
  for (auto left = take_number(state); left > 0; --left) {
    place += take_number(state);
    histogram_.add(static_cast<std::uint32_t>(place), take_number(state));
  }
  while (!state.empty()) {
    const auto p = take_value<PackedPoint>(state);
    sample_.add({p.number, {p.x, p.y, p.z}, p.deviation_mm});
  }
}

}  // namespace abbe
