#pragma once

// Some of many points.
#include <Eigen/Core>
#include <algorithm>
#include <cstdint>

#include "abbe/geometry/mixed_bits.h"

namespace abbe {

/// Which one of `every` consecutive things is chosen, 0 .. every - 1: as if at random, always the same. Every n-th
/// could be in the same place of each row of a raster.
constexpr std::uint64_t chosen_of_group(std::uint64_t group, std::uint64_t every) {
  return every <= 1 ? 0 : mixed_bits(group) % every;
}

/// One of each few consecutive things, so that about `count` of `all` are chosen; all of them if these are fewer.
class EvenChoice {
 public:
  EvenChoice(Eigen::Index all, Eigen::Index count)
      : all_(all), every_(std::max<Eigen::Index>(1, all / std::max<Eigen::Index>(1, count))) {}

  Eigen::Index size() const { return (all_ + every_ - 1) / every_; }
  /// Number of the k-th that is chosen; ascending.
  Eigen::Index operator[](Eigen::Index k) const {
    const Eigen::Index first = k * every_;
    const auto group = static_cast<std::uint64_t>(std::min(every_, all_ - first));
    return first + static_cast<Eigen::Index>(chosen_of_group(static_cast<std::uint64_t>(k), group));
  }

  Eigen::Matrix3Xd of(const Eigen::Matrix3Xd& points) const {
    Eigen::Matrix3Xd some(3, size());
    for (Eigen::Index k = 0; k < some.cols(); ++k) some.col(k) = points.col((*this)[k]);
    return some;
  }

 private:
  Eigen::Index all_, every_;
};

}  // namespace abbe
