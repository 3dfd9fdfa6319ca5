#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "abbe/errors/chain_plan.h"
#include "abbe/errors/poses.h"
#include "abbe/geometry/rigid_transform.h"

namespace abbe {

/// Poses and deviations of one block, reused from block to block; arrays as in ErrorMap.
struct DeviationBlock {
  static constexpr std::size_t kSize = 4096;

  std::size_t first = 0, count = 0;
  std::vector<std::vector<double>> positions;
  std::vector<const double*> axis;
  std::vector<std::vector<double>> states;
  std::vector<const double*> state;  ///< [states of the machine] or empty, as PositionArrays::state
  std::array<std::vector<double>, 3> point, seen, displacement, rotation;
  std::array<std::vector<double>, 9> reference_rotation, actual_rotation;
  std::vector<double> norm;
  std::vector<std::uint8_t> covered, also_covered;

  PositionArrays position_arrays() const { return {axis, count, state}; }
  /// @param shifted  becomes the pointers
  PositionArrays position_arrays(std::vector<const double*>& shifted, std::size_t from, std::size_t number) const;
};

/// Deviation of the functional point and the orientation, actual against reference, block by block. Thread-safe.
class DeviationModel {
 public:
  DeviationModel(const Machine& machine, const ErrorSet& actual, const ErrorSet* reference, bool orientation);

  /// Fills everything but the axes' positions from them, without removing anything.
  /// displacement and norm are those of datum * actual.
  void evaluate(DeviationBlock& block, const RigidTransform& datum) const;

  const ChainPlan& actual() const { return actual_; }
  const Eigen::Vector3d& actual_tip() const { return actual_tip_; }

 private:
  ChainPlan actual_, reference_;
  Eigen::Vector3d actual_tip_, reference_tip_;
  bool orientation_;
};

/// Number of blocks of a source, and the poses of one of them.
std::size_t block_count(const PoseSource& poses);
void load_block(const PoseSource& poses, std::size_t index, DeviationBlock& block);

}  // namespace abbe
