#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "abbe/identify/identify.h"
#include "abbe/identify/planning_space.h"
#include "abbe/identify/problem.h"

namespace abbe {

/// Readings that could be added to a problem, as rows of their whitened Jacobian.
struct PossibleMeasurement {
  std::string words;              ///< "readings with another reflector that is not on their line"
  PlanningCandidates::Rows rows;  ///< [rows, p + own]: columns of the estimates, then of unknowns of its own
  std::size_t own = 0;            ///< unknowns that the problem does not have: the pose of another station
};

/// What one direction of the parameters means for the person who measured.
struct Advice {
  std::vector<std::size_t> parameters;  ///< entries of the estimates that the direction mixes, largest first
  std::string text;                     ///< what is not seen, or only weakly
  std::string remedy;                   ///< which measurement would show it, or why none would
  bool unseen = true;                   ///< false: seen, but hardly
  bool shown = false;                   ///< a trial with simulated readings showed that the remedy helps
};

struct AdviceOptions {
  /// A direction is weak if its standard uncertainty is above this part of the typical size of errors.
  double weak = 1;
  double typical_length = 0.01;  ///< mm, size of an error motion or a location error of a usual machine
  double typical_angle = 5e-5;   ///< rad
};

/// What a tracker could read additionally, easiest first: more positions of one axis over its measured range, all axes
/// together, another reflector, another station. For observations of other instruments nothing. Derivatives at errors
/// of zero and at the present values of the set-up's unknowns.
std::vector<PossibleMeasurement> possible_measurements(const Problem& problem);

/// Says for every direction fixed by the gauge, and for every one that is seen only weakly, which of the possible
/// measurements would show it. Each is tried: its rows are added to the information, and the direction has to become
/// separable (or its variance to fall to a quarter). What none shows is a convention and needs no measurement.
/// @param problem  observations stand at the estimates, and do so afterwards
std::vector<Advice> unseen_advice(const Problem& problem, const Identification& identification,
                                  const std::vector<PossibleMeasurement>& possible, const AdviceOptions& options = {});

}  // namespace abbe
