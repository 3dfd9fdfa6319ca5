#pragma once

// Internal to identify: readings that are tried, so that advice is verified and not guessed.
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "abbe/errors/poses.h"
#include "abbe/identify/unseen.h"

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

/// An unknown of trial readings: shared with the problem, or one of their own.
struct TrialUnknown {
  bool own = false;
  double standard_uncertainty = 0;  ///< own: known within that, mm or rad; 0: open
};

/// Rows of trial readings over the estimates of a problem, all errors zero.
/// @param observations  index into Problem::observations: those unknowns are shared that have the same name there
/// @param unknowns      [trial.unknowns()]
PossibleMeasurement trial_measurement(const Problem& problem, std::size_t observations, std::string words,
                                      Observations& trial, const std::vector<TrialUnknown>& unknowns);

/// Rows of the estimates with the measurement's own unknowns taken out: what it says whatever they are. [rows, p]
Eigen::MatrixXd rows_without_own(const PossibleMeasurement& measurement, Eigen::Index parameters);

/// Size of each estimate that matters, [p] mm or rad. What is known of a set-up beforehand is coarse.
Eigen::VectorXd typical_sizes(const std::vector<EstimatedParameter>& parameters, const AdviceOptions& options);

/// Errors of a problem with all values zero.
ErrorSet without_errors(const Problem& problem);

/// What trackers, or any other instruments of the problem, could read additionally where they stand.
void add_tracker_readings(const Problem& problem, std::vector<PossibleMeasurement>& list);
void add_instrument_readings(const Problem& problem, std::vector<PossibleMeasurement>& list);
/// Instruments that could be set up besides: easiest first, at last one that sees all that can be seen.
void add_further_instruments(const Problem& problem, std::vector<PossibleMeasurement>& list);

}  // namespace abbe
