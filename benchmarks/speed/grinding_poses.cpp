#include "grinding_poses.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "abbe/geometry/parallel_blocks.h"

namespace abbe::benchmarks {
namespace {

constexpr std::size_t kPoints = 12, kInner = kPoints * kPoints * kPoints;

}  // namespace

GrindingPoses::GrindingPoses(double largest_angle) {
  RandomStream random(36);
  ErrorSet errors;
  for (const char letter : std::string("CXZAYB")) {
    Axis axis;
    axis.name.push_back(letter);
    axis_kind_from_letter(letter, axis.kind);
    axis.direction = direction_from_letter(letter);
    axis.side = letter == 'C' ? ChainSide::workpiece : ChainSide::tool;
    const double step = axis.kind == AxisKind::linear ? 40 : std::numbers::pi / 6;
    Basis basis;
    basis.kind = BasisKind::table_linear;
    for (std::size_t i = 0; i < kPoints; ++i) basis.nodes.push_back(step * static_cast<double>(i));
    basis.to = basis.nodes.back();
    for (int k = 0; k < kComponentCount; ++k) {
      ErrorMotion motion{machine_.axes.size(), static_cast<Component>(k), basis, std::vector<double>(kPoints), {}};
      for (double& value : motion.coefficients) value = random.uniform(-1, 1) * (k < 3 ? 0.008 : largest_angle);
      errors.motions.push_back(motion);
    }
    positions_.push_back(basis.nodes);
    machine_.axes.push_back(axis);
  }
  plans_.emplace_back(machine_, errors, Body::tool, Body::bed);
  plans_.emplace_back(machine_, errors, Body::workpiece, Body::bed);
  plans_.emplace_back(machine_, ErrorSet{}, Body::tool, Body::bed);
  plans_.emplace_back(machine_, ErrorSet{}, Body::workpiece, Body::bed);
  inner_.assign(3, std::vector<double>(kInner));
  for (std::size_t k = 0; k < kInner; ++k) {
    inner_[0][k] = positions_[3][k % kPoints];
    inner_[1][k] = positions_[4][k / kPoints % kPoints];
    inner_[2][k] = positions_[5][k / kPoints / kPoints];
  }
}

GrindingPoses::Statistics GrindingPoses::evaluate_some(std::size_t outer) const {
  constexpr std::size_t n = ChainPlan::kBlockSize;
  std::array<std::array<double, n>, 3> command;
  std::array<std::array<double, n>, 3> tool, workpiece;
  std::array<std::array<std::array<double, n>, 3>, 4> seen;
  command[0].fill(positions_[0][outer % kPoints]);
  command[1].fill(positions_[1][outer / kPoints % kPoints]);
  command[2].fill(positions_[2][outer / kPoints / kPoints]);
  for (std::size_t i = 0; i < 3; ++i) tool[i].fill(i == 0 ? 200 : 0), workpiece[i].fill(i == 2 ? 400 : 0);
  Statistics some;
  for (std::size_t first = 0; first < kInner; first += n) {
    const std::size_t count = std::min(n, kInner - first);
    const std::array<const double*, 6> axis = {command[0].data(), command[1].data(), command[2].data(),
                                               &inner_[0][first], &inner_[1][first], &inner_[2][first]};
    for (std::size_t p = 0; p < 4; ++p) {
      const auto& start = p % 2 == 0 ? tool : workpiece;
      plans_[p].transform({axis, count}, {start[0].data(), start[1].data(), start[2].data()},
                          {seen[p][0].data(), seen[p][1].data(), seen[p][2].data()});
    }
    for (std::size_t k = 0; k < count; ++k) {
      double square = 0;
      for (std::size_t i = 0; i < 3; ++i) {
        const double e = (seen[1][i][k] - seen[0][i][k]) - (seen[3][i][k] - seen[2][i][k]);
        square += e * e;
      }
      const double size = std::sqrt(square);
      some.mean += size;
      some.largest = std::max(some.largest, size);
    }
  }
  return some;
}

GrindingPoses::Statistics GrindingPoses::evaluate(int threads) const {
  std::vector<Statistics> parts(kInner);
  for_each_block(kInner, threads, [&](std::size_t outer) { parts[outer] = evaluate_some(outer); });
  Statistics all;
  for (const Statistics& part : parts) {
    all.mean += part.mean / static_cast<double>(kPoses);
    all.largest = std::max(all.largest, part.largest);
  }
  return all;
}

}  // namespace abbe::benchmarks
