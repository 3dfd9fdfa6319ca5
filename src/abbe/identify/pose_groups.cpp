#include "abbe/identify/pose_groups.h"

#include <algorithm>
#include <map>
#include <utility>

#include "abbe/geometry/decompositions.h"

namespace abbe {
namespace {

constexpr double kNotSeen = 1e-12;  // of the largest square: below is rounding

}  // namespace

PoseGroups::PoseGroups(const Observations& observations, const std::vector<std::uint8_t>& use,
                       const std::vector<std::size_t>& common)
    : observations_(&observations), rows_(static_cast<std::size_t>(observations.rows())) {
  const std::size_t count = observations.reading_count();
  std::map<std::vector<double>, std::size_t> known;
  group_of_.resize(count);
  for (std::size_t k = 0; k < count; ++k) {
    std::size_t group = groups_.size();
    const bool used = use.empty() || use[k] != 0;
    if (used) {
      std::vector<double> key =
          common.empty() ? observations.positions(k) : std::vector<double>{static_cast<double>(common[k])};
      group = known.emplace(std::move(key), group).first->second;
    }
    if (group == groups_.size()) groups_.emplace_back().used = used;
    groups_[group].readings.push_back(k);
    group_of_[k] = group;
  }
  update();
}

void PoseGroups::update() {
  constexpr std::size_t kBlock = Observations::kBlockSize;
  const std::size_t count = observations_->reading_count();
  displacement_.assign(3 * rows_ * count, 0.0);
  std::vector<double> block(3 * rows_ * kBlock);
  for (std::size_t first = 0; first < count; first += kBlock) {
    const std::size_t n = std::min(kBlock, count - first);
    if (!observations_->displacement_rows(first, n, block.data())) break;
    for (std::size_t k = 0; k < n; ++k)
      for (std::size_t row = 0; row < rows_; ++row)
        for (std::size_t c = 0; c < 3; ++c)
          displacement_[(3 * rows_) * (first + k) + 3 * row + c] = block[(c * rows_ + row) * n + k];
  }
  for (Group& group : groups_) {
    Eigen::Matrix3d square = Eigen::Matrix3d::Zero();
    for (const std::size_t reading : group.readings)
      for (std::size_t row = 0; row < rows_; ++row) {
        const Eigen::Map<const Eigen::Vector3d> z(displacement(reading) + 3 * row);
        square += z * z.transpose();
      }
    if (!square.allFinite()) square.setZero();  // a reading that is left out may be no number at all
    const SymmetricEigen<3> eigen(square);
    group.axes = eigen.eigenvectors();
    group.squares = eigen.eigenvalues();
    const double least = kNotSeen * group.squares[2];
    for (double& value : group.squares)
      if (!(value > least)) value = 0;
  }
}

std::size_t PoseGroups::most_readings() const {
  std::size_t most = 0;
  for (const Group& group : groups_)
    if (group.used && group.squares[2] > 0) most = std::max(most, group.readings.size());
  return most;
}

}  // namespace abbe
