#include "abbe/verify/parts/deviation_block.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "abbe/geometry/rotation.h"

namespace abbe {
namespace {

ErrorSet without_errors(const ErrorSet& like) {
  ErrorSet none;
  none.composition = like.composition;
  return none;
}

RotationArrays arrays(std::array<std::vector<double>, 9>& r) {
  RotationArrays result;
  for (std::size_t i = 0; i < 9; ++i) result.r[i] = r[i].data();
  return result;
}

/// Rotation vectors of actual * reference^T, of a block.
void rotation_vectors(DeviationBlock& block, const Eigen::Matrix3d& datum) {
  for (std::size_t k = 0; k < block.count; ++k) {
    Eigen::Matrix3d a, r;
    for (Eigen::Index i = 0; i < 3; ++i) {
      for (Eigen::Index j = 0; j < 3; ++j) {
        a(i, j) = block.actual_rotation[static_cast<std::size_t>(3 * i + j)][k];
        r(i, j) = block.reference_rotation[static_cast<std::size_t>(3 * i + j)][k];
      }
    }
    const Eigen::Matrix3d e = datum * a * r.transpose();
    Eigen::Vector3d v = 0.5 * Eigen::Vector3d(e(2, 1) - e(1, 2), e(0, 2) - e(2, 0), e(1, 0) - e(0, 1));
    const double s = v.squaredNorm();
    // asin(x) / x by its series where that is exact to rounding; errors of a machine always are.
    if (s < 1e-6 && e.trace() > 0) {
      v *= 1 + s / 6 + 3 * s * s / 40;
    } else {
      v = rotation_vector(e);
    }
    for (int c = 0; c < 3; ++c) block.rotation[static_cast<std::size_t>(c)][k] = v[c];
  }
}

}  // namespace

PositionArrays DeviationBlock::position_arrays(std::vector<const double*>& shifted, std::size_t from,
                                               std::size_t number) const {
  shifted.resize(axis.size() + state.size());
  for (std::size_t i = 0; i < axis.size(); ++i) shifted[i] = axis[i] + from;
  for (std::size_t j = 0; j < state.size(); ++j) shifted[axis.size() + j] = state[j] + from;
  const std::span<const double* const> all(shifted);
  return {all.first(axis.size()), number, all.subspan(axis.size())};
}

DeviationModel::DeviationModel(const Machine& machine, const ErrorSet& actual, const ErrorSet* reference,
                               bool orientation)
    : actual_(machine, actual, Body::tool, Body::workpiece),
      reference_(machine, reference ? *reference : without_errors(actual), Body::tool, Body::workpiece),
      actual_tip_(machine.tool_offset + actual.tool_offset_error),
      reference_tip_(machine.tool_offset + (reference ? reference->tool_offset_error : Eigen::Vector3d::Zero())),
      orientation_(orientation) {}

void DeviationModel::evaluate(DeviationBlock& block, const RigidTransform& datum) const {
  const std::size_t n = block.count;
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::vector<double>* values : {&block.point[c], &block.seen[c], &block.displacement[c]}) values->resize(n);
    std::fill_n(block.point[c].begin(), n, reference_tip_[static_cast<int>(c)]);
    std::fill_n(block.seen[c].begin(), n, actual_tip_[static_cast<int>(c)]);
  }
  block.norm.resize(n);
  block.covered.resize(n);
  block.also_covered.resize(n);
  RotationArrays actual_rotation, reference_rotation;
  if (orientation_) {
    for (std::size_t i = 0; i < 9; ++i) {
      block.actual_rotation[i].resize(n);
      block.reference_rotation[i].resize(n);
    }
    for (std::vector<double>& values : block.rotation) values.resize(n);
    actual_rotation = arrays(block.actual_rotation);
    reference_rotation = arrays(block.reference_rotation);
  }
  const auto transform = [&](const ChainPlan& plan, std::array<std::vector<double>, 3>& p, RotationArrays rotation,
                             std::uint8_t* covered) {
    plan.transform(block.position_arrays(), {p[0].data(), p[1].data(), p[2].data()},
                   {p[0].data(), p[1].data(), p[2].data()}, rotation, covered);
  };
  transform(reference_, block.point, reference_rotation, block.also_covered.data());
  transform(actual_, block.seen, actual_rotation, block.covered.data());

  const Eigen::Matrix3d& r = datum.rotation;
  const Eigen::Vector3d& t = datum.translation;
  const bool moved = !r.isIdentity(0) || !t.isZero(0);
  for (std::size_t k = 0; k < n; ++k) {
    double x = block.seen[0][k], y = block.seen[1][k], z = block.seen[2][k];
    if (moved) {
      const Eigen::Vector3d p = r * Eigen::Vector3d(x, y, z) + t;
      x = p[0];
      y = p[1];
      z = p[2];
    }
    const double dx = x - block.point[0][k], dy = y - block.point[1][k], dz = z - block.point[2][k];
    block.displacement[0][k] = dx;
    block.displacement[1][k] = dy;
    block.displacement[2][k] = dz;
    block.norm[k] = std::sqrt(dx * dx + dy * dy + dz * dz);
    block.covered[k] = block.covered[k] && block.also_covered[k] ? 1 : 0;
  }
  if (orientation_) rotation_vectors(block, r);
}

std::size_t block_count(const PoseSource& poses) {
  return (poses.count + DeviationBlock::kSize - 1) / DeviationBlock::kSize;
}

void load_block(const PoseSource& poses, std::size_t index, DeviationBlock& block) {
  block.first = index * DeviationBlock::kSize;
  block.count = std::min(DeviationBlock::kSize, poses.count - block.first);
  block.positions.resize(poses.axes);
  block.axis.resize(poses.axes);
  std::vector<double*> target(poses.axes);
  for (std::size_t i = 0; i < poses.axes; ++i) {
    block.positions[i].resize(DeviationBlock::kSize);
    block.axis[i] = target[i] = block.positions[i].data();
  }
  poses.fill(block.first, block.count, target.data());
  block.state.clear();
  if (!poses.fill_states) return;
  block.states.resize(poses.states);
  target.clear();
  for (std::vector<double>& values : block.states) {
    values.resize(DeviationBlock::kSize);
    target.push_back(values.data());
    block.state.push_back(values.data());
  }
  poses.fill_states(block.first, block.count, target.data());
}

}  // namespace abbe
