#pragma once

// Internal to identify: readings that are tried, so that advice is verified and not guessed.
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "abbe/identify/trust/unseen.h"
#include "abbe/instruments/further_readings.h"

namespace abbe {

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

/// Instruments that could be set up besides: easiest first, at last one that sees all that can be seen.
void add_further_instruments(const Problem& problem, std::vector<PossibleMeasurement>& list);

}  // namespace abbe
