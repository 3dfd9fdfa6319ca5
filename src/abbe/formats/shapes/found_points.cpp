#include "abbe/formats/shapes/found_points.h"

#include <fmt/format.h>

#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/list_text.h"

namespace abbe {

void FoundPoints::finish(const std::string& file, PointCloudFile& result) {
  result.left_out = not_finite_ + invalid_;
  if (kept_ == 0) {
    throw InputError({.file = file},
                     result.left_out == 0 ? "there are no points in the file"
                                          : fmt::format("none of the {} points has coordinates", result.left_out),
                     "at least one point");
  }
  const auto left_out = [&](std::size_t count, const char* why) {
    if (count == 0) return;
    result.notes.push_back(fmt::format("{} left out: {}", counted(count, "point is", "points are"), why));
  };
  left_out(not_finite_, "not all of their coordinates are finite numbers");
  left_out(invalid_, "the file marks their coordinates as invalid");
  if (cloud_.points.cols() != kept_) cloud_.points.conservativeResize(3, kept_);
  if (has_normals_ && without_normal_ > 0) {
    result.notes.push_back(fmt::format("the normals of the file are not used: {} none",
                                       counted(without_normal_, "point has", "points have")));
    cloud_.normals.resize(3, 0);
  } else if (cloud_.normals.cols() != 0 && cloud_.normals.cols() != kept_) {
    cloud_.normals.conservativeResize(3, kept_);
  }
  result.cloud = std::move(cloud_);
}

}  // namespace abbe
