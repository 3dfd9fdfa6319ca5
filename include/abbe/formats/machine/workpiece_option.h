#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "abbe/compensate/workpiece_errors.h"
#include "abbe/compensate/workpiece_expansion.h"
#include "abbe/errors/poses.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// Options of a command about a workpiece that is not at 20 degC.
struct WorkpieceOptions {
  std::optional<double> expansion;    ///< --workpiece-expansion-um-per-m-K
  std::optional<double> u_expansion;  ///< --u-workpiece-expansion-um-per-m-K
  std::optional<double> temperature;  ///< --workpiece-temperature-degC: the same at all poses
  std::string state;                  ///< --workpiece-state: a state of the machine, its temperature
  std::optional<double> u_kelvin;     ///< --u-workpiece-temperature-K
  std::vector<double> fixed_mm;       ///< --workpiece-fixed-mm: three coordinates, or none
  bool any() const;
};

/// An option that is a number.
struct WorkpieceNumber {
  const char* option;
  std::optional<double> WorkpieceOptions::*value;
  const char* words;
};
std::span<const WorkpieceNumber> workpiece_numbers();

/// The expansion that options describe; nothing without them. Its temperature is a column of the poses, or the value of
/// --state, which is then put into the poses.
/// @param states  texts of --state
/// @throws InputError for options that miss each other, numbers out of range, and a temperature that is not given or
///   whose reference is not 20 degC
std::optional<WorkpieceExpansion> workpiece_option(const Machine& machine, const WorkpieceOptions& options,
                                                   const std::vector<std::string>& states, PoseList& poses);

/// The same for jobs that are done at one temperature: the stated one, or the value of --state.
/// @returns with WorkpieceExpansion::temperature; nothing without options
/// @throws InputError
std::optional<WorkpieceExpansion> workpiece_option(const Machine& machine, const WorkpieceOptions& options,
                                                   const std::vector<std::string>& states);

/// The workpiece of a job at one temperature as errors of the machine. @throws InputError for errors that are not
/// composed as in ISO 230, and where the temperature is missing or not a number
WorkpieceErrors workpiece_errors(const Machine& machine, const WorkpieceExpansion& workpiece, const ErrorSet& errors);

/// Errors with those of a workpiece, and their covariance.
struct ErrorsOnWorkpiece {
  ErrorSet errors;
  Eigen::MatrixXd covariance;  ///< 0 x 0: nothing is stated
};

/// @param covariance  of the errors; 0 x 0: what they state of their standard uncertainties
/// @throws InputError as workpiece_errors()
ErrorsOnWorkpiece errors_on_workpiece(const Machine& machine, const WorkpieceExpansion& workpiece,
                                      const ErrorSet& errors, const Eigen::MatrixXd& covariance);

}  // namespace abbe
