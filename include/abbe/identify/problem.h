#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "abbe/errors/error_set.h"
#include "abbe/instruments/observations.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// Says which unknown is meant: a coefficient of the machine's errors, or a set-up unknown of one of the observations.
struct ParameterId {
  static constexpr std::size_t kMachine = static_cast<std::size_t>(-1);
  std::size_t observations = kMachine;  ///< index into Problem::observations, or kMachine
  std::size_t index = 0;                ///< into ErrorSet::parameters() or Observations::unknowns()
  bool is_machine() const { return observations == kMachine; }
  bool operator==(const ParameterId&) const = default;
};

/// Independent knowledge of one estimated parameter; enters as one more residual (value - parameter) / uncertainty.
struct Prior {
  ParameterId parameter;
  double value = 0;                 ///< mm or rad
  double standard_uncertainty = 0;  ///< mm or rad, > 0
};

/// Result of an earlier identification as knowledge of several parameters together.
///
/// Adds (x - value)' information (x - value) / 2 to the cost. The information matrix may be singular: what the earlier
/// readings did not see stays open, so that no gauge of theirs is taken for a measurement.
struct JointPrior {
  std::vector<ParameterId> parameters;
  Eigen::VectorXd value;        ///< mm or rad
  Eigen::MatrixXd information;  ///< symmetric, positive semi-definite; inverse covariance where that exists
  double residual_count = 0;    ///< degrees of freedom it stands for: its rank
};

/// One set of readings and what is estimated of its set-up.
struct SelectedObservations {
  std::shared_ptr<Observations> observations;  ///< its present unknown_values() are the start; shared by copies
  std::vector<std::size_t> unknowns;           ///< estimated ones, indices into Observations::unknowns()
  std::vector<std::uint8_t> use;               ///< per reading: 0 leaves it out; empty: all are used
  /// Per reading: the same number for readings whose displacement is common, where variances are estimated; empty: for
  /// those at the same pose.
  std::vector<std::size_t> common{};
};

/// What is to be identified from what.
///
/// The vector of estimates is ordered: machine_parameters, then the unknowns of observations[0], of observations[1],
/// ...
struct Problem {
  Machine machine;
  ErrorSet errors;  ///< structure (the one the observations were built with), start values and values that stay fixed
  std::vector<std::size_t> machine_parameters;  ///< estimated ones, indices into ErrorSet::parameters()
  std::vector<SelectedObservations> observations;
  std::vector<Prior> priors;  ///< of estimated parameters only; others are ignored
  std::vector<JointPrior>
      joint_priors;  ///< parts about parameters that are not estimated are taken at their present value
};

/// One entry of the vector of estimates.
struct EstimatedParameter {
  std::string name;  ///< "EXX[P2]", "tracker1.x"
  bool is_angle = false;
  ParameterId id;
  bool is_pure_number = false;  ///< of a set-up: a scale
};

/// A problem in which everything is estimated: all machine parameters and all set-up unknowns, all readings used.
Problem estimate_everything(const Machine& machine, const ErrorSet& errors,
                            const std::vector<std::shared_ptr<Observations>>& observations);

/// Observations that somebody else owns, who outlives whatever they are given to.
std::shared_ptr<Observations> borrowed(Observations& observations);

/// The vector of estimates in words. Names of set-up unknowns are taken as the observations give them.
std::vector<EstimatedParameter> estimated_parameters(const Problem& problem);

/// Number of estimated parameters.
std::size_t estimated_count(const Problem& problem);

/// Present values: from Problem::errors and Observations::unknown_values(); mm or rad.
Eigen::VectorXd present_values(const Problem& problem);

/// A point at which readings are evaluated: all values, estimated or not.
struct ReadingPoint {
  std::vector<double> machine;              ///< of ErrorSet::parameters(), mm or rad
  std::vector<std::vector<double>> setups;  ///< per observations: of Observations::unknowns(), mm or rad
  bool operator==(const ReadingPoint&) const = default;
};

/// The point of these estimates; the rest as in the problem.
ReadingPoint reading_point(const Problem& problem, const Eigen::VectorXd& estimates);
void set_observations(const Problem& problem, const ReadingPoint& point);

/// Sets all observations to these estimates (the rest as in the problem). Does not change problem.errors.
void set_observations(const Problem& problem, const Eigen::VectorXd& estimates);

/// Writes estimates into problem.errors and into the observations.
void keep_estimates(Problem& problem, const Eigen::VectorXd& estimates);

/// Position of a parameter in the vector of estimates; estimated_count() if it is not estimated.
std::size_t find_estimated(const Problem& problem, const ParameterId& id);

/// Readings used, and residuals used (readings times rows), priors not counted.
std::size_t used_reading_count(const SelectedObservations& selected);
std::size_t used_reading_count(const Problem& problem);
std::size_t used_residual_count(const Problem& problem);

}  // namespace abbe
