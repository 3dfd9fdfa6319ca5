#include "abbe/formats/nc/nc_offsets.h"

namespace abbe {

void NcOffsets::set_system(std::size_t system, std::uint32_t words, const NcAxisValues& values) {
  is_said_[system] = true;
  for_axes(words, [&](std::size_t k) { systems_[system][k] = values[k]; });
}

NcAxisValues NcOffsets::system_at(std::uint32_t words, const NcAxisValues& position, const NcAxisValues& values) const {
  NcAxisValues offset{};
  for_axes(words, [&](std::size_t k) { offset[k] = position[k] - axis_offset_[k] - counted_tool(k) - values[k]; });
  return offset;
}

void NcOffsets::set_axis_offset(std::uint32_t words, const NcAxisValues& values) {
  for_axes(words, [&](std::size_t k) { axis_offset_[k] = values[k]; });
  stored_axis_offset_ = axis_offset_;
}

void NcOffsets::shift_axis_offset(std::uint32_t words, const NcAxisValues& shown, const NcAxisValues& values) {
  for_axes(words, [&](std::size_t k) { axis_offset_[k] += shown[k] - values[k]; });
  stored_axis_offset_ = axis_offset_;
}

NcAxisValues NcOffsets::sum() const {
  NcAxisValues sum{};
  for (std::size_t k = 0; k < kAxisWords; ++k) {
    sum[k] = systems_[system_][k] + axis_offset_[k];
    if (!tool_centre_) sum[k] += tool_[k];
  }
  return sum;
}

double NcOffsets::value_for_axis_offset(std::size_t axis, double position) const {
  const double base = systems_[system_][axis] + counted_tool(axis);
  return position - base - axis_offset_[axis];
}

}  // namespace abbe
