#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

// Which sensors of states matter: what becomes of the error if some of them are not there. docs/planning.md derives it.

namespace abbe {

/// Terms of errors and the sensors without which they cannot be used.
struct SensorTerms {
  std::vector<std::string> names;               ///< [sensors]
  std::vector<std::vector<std::size_t>> needs;  ///< [p] sensors of each parameter; empty: it needs none
  Eigen::VectorXd size;  ///< [p] standard deviation to be expected of each parameter before anything is measured, > 0
};

/// Readings and predictions as they are planned.
struct SensorPrediction {
  Eigen::MatrixXd information;  ///< A'A, [p, p], A the whitened Jacobian of the readings
  Eigen::MatrixXd prediction;   ///< P'P over the number of poses, [p, p]: mean of the squared displacement, mm^2
};

/// Readings that were taken, linear about a solution.
struct SensorReadings {
  Eigen::MatrixXd rows;                ///< [n, p] whitened
  Eigen::VectorXd values;              ///< [n] whitened: what the parameters are to explain
  std::vector<std::uint8_t> held_out;  ///< [n] 1: not used in the fit
};

/// Root mean square of what remains of the displacement, mm, if the errors are identified and corrected with these
/// sensors only: the uncertainty of the terms that remain, and what the others do that these cannot explain.
/// @param has  [sensors] 1: there
/// @throws std::invalid_argument for sizes that do not agree
double predicted_error(const SensorTerms& terms, const SensorPrediction& planned, const std::vector<std::uint8_t>& has);

/// Root mean square of the held-out residuals, in standard uncertainties, of a fit to the other readings.
/// @throws std::invalid_argument for sizes that do not agree, or if nothing is held out
double held_out_error(const SensorTerms& terms, const SensorReadings& readings, const std::vector<std::uint8_t>& has);

/// The error with one sensor less, or with one more.
struct SensorStep {
  std::size_t sensor = 0;
  double error = 0;
};

/// A course that follows from another one, or from all others together.
struct SensorLikeness {
  static constexpr std::size_t kAllOthers = static_cast<std::size_t>(-1);
  std::size_t sensor = 0, other = kAllOthers;
  double left = 0;   ///< root mean square of what remains of it, in its unit
  double whole = 0;  ///< of its deviation from its mean
  bool still() const { return whole == 0; }
};

struct SensorSelection {
  std::vector<std::string> names;     ///< [sensors]
  double none = 0, all = 0;           ///< error without any sensor, and with all of them
  std::vector<SensorStep> without;    ///< each one taken from all, the one that is missed most first
  std::vector<SensorStep> forward;    ///< added one by one, the best first
  std::size_t enough = 0;             ///< so many of `forward` come within kEnoughError of all
  std::vector<std::string> courses;   ///< names of what SensorLikeness counts: states, lags among them
  std::vector<SensorLikeness> alike;  ///< what cannot be told apart, or does not change
};

/// A selection is enough if its error exceeds that of all sensors by less than this part.
inline constexpr double kEnoughError = 0.05;
/// A course follows from another if less than this part of its deviation remains.
inline constexpr double kSameCourse = 0.1;

/// Takes each sensor away, and adds one after the other.
/// @param error  of a choice of sensors
SensorSelection select_sensors(const std::vector<std::string>& names,
                               const std::function<double(const std::vector<std::uint8_t>& has)>& error);

/// Courses that follow from others, by regression with a constant.
/// @param course  [times, courses]
std::vector<SensorLikeness> like_sensors(const Eigen::MatrixXd& course);

/// "hall follows from column: 0.02 of its deviation of 2.1 (root mean square) remain"
/// @param courses  their names
std::string likeness_words(const std::vector<std::string>& courses, const SensorLikeness& one);
nlohmann::ordered_json likeness_json(const std::vector<std::string>& courses, const SensorLikeness& one);

}  // namespace abbe
