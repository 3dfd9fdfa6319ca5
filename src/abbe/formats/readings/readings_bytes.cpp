#include "abbe/formats/readings/readings_bytes.h"

#include <cassert>
#include <cstdint>
#include <cstring>
#include <string>

#include "abbe/geometry/numbered_work.h"

namespace abbe {
namespace {

class Packer {
 public:
  explicit Packer(std::vector<std::byte>& bytes) : bytes_(bytes) {}

  void add(std::uint64_t size) { add_bytes(&size, sizeof(size)); }
  template <class Value>
  void add(const std::vector<Value>& values) {
    add(values.size());
    add_bytes(values.data(), values.size() * sizeof(Value));
  }
  template <class Value>
  void add(const std::vector<std::vector<Value>>& columns) {
    add(columns.size());
    for (const std::vector<Value>& column : columns) add(column);
  }
  void add(const std::vector<std::string>& texts) {
    add(texts.size());
    for (const std::string& text : texts) {
      add(text.size());
      add_bytes(text.data(), text.size());
    }
  }

 private:
  void add_bytes(const void* from, std::size_t size) {
    const std::byte* begin = static_cast<const std::byte*>(from);
    bytes_.insert(bytes_.end(), begin, begin + size);
  }

  std::vector<std::byte>& bytes_;
};

class Unpacker {
 public:
  explicit Unpacker(std::span<const std::byte>& bytes) : bytes_(bytes) {}

  template <class Value>
  void take(std::vector<Value>& values) {
    values.resize(size_of(sizeof(Value)));
    take_bytes(values.data(), values.size() * sizeof(Value));
  }
  template <class Value>
  void take(std::vector<std::vector<Value>>& columns) {
    columns.resize(size_of(sizeof(std::uint64_t)));
    for (std::vector<Value>& column : columns) take(column);
  }
  void take(std::vector<std::string>& texts) {
    texts.resize(size_of(sizeof(std::uint64_t)));
    for (std::string& text : texts) {
      text.resize(size_of(1));
      take_bytes(text.data(), text.size());
    }
  }

 private:
  /// A number of values, each of which takes at least so many bytes.
  std::size_t size_of(std::size_t each) {
    std::uint64_t size = 0;
    take_bytes(&size, sizeof(size));
    if (size > bytes_.size() / each) throw WorkError("readings are cut off");
    return static_cast<std::size_t>(size);
  }
  void take_bytes(void* to, std::size_t size) {
    if (size > bytes_.size()) throw WorkError("readings are cut off");
    if (size > 0) std::memcpy(to, bytes_.data(), size);
    bytes_ = bytes_.subspan(size);
  }

  std::span<const std::byte>& bytes_;
};

/// Calls with all columns of readings, in an order of their own.
template <class Readings, class Visit>
void for_columns(Readings& readings, const Visit& visit) {
  visit(readings.poses.axis);
  visit(readings.poses.approach);
  visit(readings.poses.state);
  visit(readings.item);
  visit(readings.inputs);
  visit(readings.measured);
  visit(readings.uncertainty);
  visit(readings.covariance);
  visit(readings.time_s);
  visit(readings.point_name);
}

}  // namespace

void pack_readings(const InstrumentReadings& readings, std::vector<std::byte>& bytes) {
  assert(readings.drift == nullptr);
  Packer packer(bytes);
  for_columns(readings, [&](const auto& columns) { packer.add(columns); });
}

InstrumentReadings unpack_readings(std::span<const std::byte>& bytes) {
  InstrumentReadings readings;
  Unpacker unpacker(bytes);
  for_columns(readings, [&](auto& columns) { unpacker.take(columns); });
  return readings;
}

}  // namespace abbe
