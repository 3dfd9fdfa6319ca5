#include "abbe/formats/readings/readings_bytes.h"

#include <cassert>

#include "abbe/formats/readings/packed_lists.h"

namespace abbe {
namespace {

/// Calls with all columns of readings, always in the same order: with lists, and with lists of lists.
template <class Readings, class OfOne, class OfMany>
void for_columns(Readings& readings, const OfOne& of_one, const OfMany& of_many) {
  of_many(readings.poses.axis);
  of_many(readings.poses.approach);
  of_many(readings.poses.state);
  of_one(readings.item);
  of_many(readings.inputs);
  of_many(readings.measured);
  of_many(readings.uncertainty);
  of_many(readings.covariance);
  of_one(readings.time_s);
  of_many(readings.point_name);
}

}  // namespace

void pack_readings(const InstrumentReadings& readings, std::vector<std::byte>& bytes) {
  assert(readings.drift == nullptr);
  for_columns(
      readings, [&](const auto& list) { pack_list(list, bytes); },
      [&](const auto& lists) {
        pack_length(lists.size(), bytes);
        for (const auto& list : lists) pack_list(list, bytes);
      });
}

InstrumentReadings unpack_readings(std::span<const std::byte>& bytes) {
  InstrumentReadings readings;
  for_columns(
      readings, [&](auto& list) { unpack_list(bytes, list); },
      [&](auto& lists) {
        lists.resize(unpack_length(bytes, sizeof(std::uint64_t)));
        for (auto& list : lists) unpack_list(bytes, list);
      });
  return readings;
}

}  // namespace abbe
