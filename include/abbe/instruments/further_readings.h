#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "abbe/errors/poses.h"
#include "abbe/instruments/observations.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// Number of readings that are tried with one instrument.
inline constexpr std::size_t kTrialReadings = 60;
/// Fewer of them that can be taken are no measurement.
inline constexpr std::size_t kLeastReadings = 6;

/// Positions of one axis.
struct TrialRange {
  double from = 0;
  double to = 0;  ///< equal to from: the axis stood still
  bool moved() const { return to > from; }
};

/// Where the axes were, over all poses; a rotary axis that went round in steps: over the whole turn.
/// @return [axes] mm or rad
std::vector<TrialRange> measured_ranges(const Machine& machine, const PoseList& poses);

/// Where an axis may go: its travel, an endless one a turn.
TrialRange whole_travel(const Axis& axis);

/// An unknown of trial readings: shared with the set-up that was measured, or one of their own.
struct TrialUnknown {
  bool own = false;
  double standard_uncertainty = 0;  ///< own: known within that, mm or rad; 0: open
};

/// Readings that a set-up could take additionally where it stands, or with a small change of it.
struct FurtherReadings {
  std::string words;                    ///< "another reflector at a known place, 100 mm off reflector1,"
  std::shared_ptr<Observations> trial;  ///< at errors of zero; unknowns of the same name are those of the set-up
  std::vector<TrialUnknown> unknowns;   ///< [trial->unknowns()]
  /// Unknowns of the set-up by the first of three, whose columns are to be multiplied by a matrix: rotation vectors
  /// that stand somewhere else than at zero.
  std::vector<std::pair<std::string, Eigen::Matrix3d>> turned;
};

}  // namespace abbe
