#include "abbe/formats/nc/nc_position.h"

#include <fmt/format.h>

namespace abbe {

void require_known_words(std::uint32_t unknown, const NcBlock& block, std::string_view why) {
  if (unknown == 0) return;
  std::string names;
  for_axes(unknown, [&](std::size_t k) {
    if (!names.empty()) names += ", ";
    names += kWrittenAxisLetters[k];
  });
  block.fail_at_begin(
      fmt::format("where {} {} is not known here, and {}", names, names.size() > 1 ? "stand" : "stands", why),
      "a G0 before it that names these axes, or where they stand when the program begins (--start X_mm=0)");
}

void NcPosition::begin_at(std::size_t axis, double value) {
  values_[axis] = axes_[axis] = value;
  known_ |= axis_bit(axis);
}

void NcPosition::count_from(const NcAxisValues& offsets) {
  zero_ = offsets;
  if (plane_) for_axes(kXyzWords, [&](std::size_t k) { zero_[k] = 0; });
}

void NcPosition::set_plane(const std::optional<NcTiltedPlane>& plane) {
  leave_plane();
  plane_ = plane;
}

void NcPosition::enter_plane(const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& axes_at) {
  plane_->map(axes_at);
  counts_in_plane_ = true;
  axes_ = values_;
  if ((known_ & kXyzWords) == kXyzWords) {
    values_ = plane_->in_plane(values_);
  } else {
    forget(kXyzWords);
  }
}

void NcPosition::leave_plane() {
  if (!counts_in_plane_) return;
  counts_in_plane_ = false;
  for_axes(kXyzWords, [&](std::size_t k) { values_[k] = axes_[k]; });
}

}  // namespace abbe
