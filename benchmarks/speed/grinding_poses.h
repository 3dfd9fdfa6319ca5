#pragma once

#include <vector>

#include "five_axis_case.h"

namespace abbe::benchmarks {

/// All 12^6 poses of the grinder w C b X Z A Y B t, 36 error motions as tables of 12 points, with statistics.
///
/// Error of a pose: displacement between the tool point and a workpiece point, actual minus nominal, in the machine
/// frame. Source: H. Wang et al., Applied Sciences 2020, 10, 2164 (structure and size of the errors; values are random
/// here).
class GrindingPoses {
 public:
  /// @param largest_angle  of the error motions, rad
  explicit GrindingPoses(double largest_angle);

  static constexpr std::size_t kPoses = 12 * 12 * 12 * 12 * 12 * 12;
  struct Statistics {
    double mean = 0, largest = 0;  ///< mm
  };
  Statistics evaluate(int threads) const;

 private:
  Statistics evaluate_some(std::size_t outer) const;
  Machine machine_;
  std::vector<ChainPlan> plans_;  ///< tool and workpiece to bed, actual; the same nominal
  std::vector<std::vector<double>> positions_;
  std::vector<std::vector<double>> inner_;  ///< commands of the three innermost axes, [1728]
};

}  // namespace abbe::benchmarks
