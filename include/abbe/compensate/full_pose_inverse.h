#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "abbe/compensate/compensated_inverse.h"
#include "abbe/errors/error_set.h"
#include "abbe/geometry/rigid_transform.h"
#include "abbe/machine/machine.h"

namespace abbe {

struct FullPoseOptions {
  double position_tolerance = 1e-9;      ///< mm
  double orientation_tolerance = 1e-11;  ///< rad
  double largest_turn = 0.01;            ///< rad; as CorrectionOptions::largest_turn, for the orientation
  int largest_iterations = 60;
};

struct FullPoseResult {
  CorrectionStatus status = CorrectionStatus::not_run;
  std::vector<double> commands;  ///< [axes] mm or rad; those of the start unless reaches_point(status)
  double position_left = 0;      ///< mm; of `commands`, NaN where not known
  double orientation_left = 0;   ///< rad
};

/// Commands of an arm whose axes together bring the tool to a point in a full orientation, with or without errors.
///
/// All axes work, unlike in CompensatedInverse, which shares the task between rotary and linear axes and so cannot
/// correct an arm that reaches a point by turning. Newton's method on the exact model: the point comes first, by the
/// shortest change of the commands; the orientation follows with what then is free, within largest_turn (Y. Nakamura,
/// H. Hanafusa, T. Yoshikawa (1987), Int. J. Robotics Research 6, 3). More than six axes: the shortest change. 1 mm of
/// a linear axis counts as 1 mrad.
class FullPoseInverse {
 public:
  /// @param held  axes that keep their commands, by index
  FullPoseInverse(const Machine& machine, const ErrorSet& errors, const FullPoseOptions& options = {},
                  std::span<const std::size_t> held = {});

  /// Commands near `start` at which the actual tool has this pose.
  FullPoseResult reach(const RigidTransform& workpiece_from_tool, std::span<const double> start) const;

  /// Why nothing can be solved; empty: it can.
  const std::string& problem() const { return problem_; }

 private:
  Machine machine_;
  ErrorSet errors_;
  FullPoseOptions options_;
  std::vector<std::size_t> working_;  ///< axes that move
  std::string problem_;
};

/// Sets of commands within travel at which the nominal machine has a pose.
struct ArmBranches {
  std::vector<std::vector<double>> commands;  ///< [found][axes]; those that differ by whole turns are all there
  bool is_singular = false;                   ///< at one of them infinitely many others are beside it
};

/// All commands of a nominal arm with six axes for a pose, from many starts over its travel: as complete as these
/// starts are dense. Steps after T. Sugihara (2011), IEEE Trans. Robotics 27, 984. The result depends on nothing but
/// the arguments.
ArmBranches arm_branches(const Machine& machine, const RigidTransform& workpiece_from_tool);

}  // namespace abbe
