#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "abbe/identify/trust/prediction.h"
#include "abbe/verify/evaluations/statistics.h"

namespace abbe {

struct Study;
struct StudyResult;

/// What the figures at unseen poses are; each has its name in docs/conventions.md.
enum class UnseenQuantity {
  volumetric_error,     ///< true error of the functional point, after the best fit of the workpiece datum
  error_at_reflectors,  ///< true error of what a tracker sees, its station fitted
  held_out_residual     ///< readings against the model: the noise of the instrument is in it
};

/// "true volumetric error", "true error at the reflectors", "residual of held-out readings".
const char* quantity_name(UnseenQuantity quantity);

/// Errors at poses that took no part in the identification.
struct UnseenPoses {
  UnseenQuantity quantity = UnseenQuantity::volumetric_error;
  std::string description;
  bool against_truth = false;  ///< else against held-out readings, which carry their own noise
  /// Nominal machine; mm. Of reflectors and readings its set-up is fitted again: station or datum, and offsets that the
  /// identification estimates.
  std::vector<double> before;
  std::vector<double> after;                 ///< identified machine; mm
  std::vector<double> expanded_uncertainty;  ///< k = 2 of the prediction, root of the trace of its covariance; mm
  double times_noise = 0;         ///< held-out readings: root mean square of residuals over stated uncertainties
  std::size_t numbers = 0;        ///< lengths compared: three per pose or tracker reading, those of an instrument
  std::size_t fitted_before = 0;  ///< numbers of the set-up fitted to these readings for `before`, not for `after`
  double coverage = 0;            ///< share of the coordinates within 2 u of the prediction; 0..1
  /// Held-out readings, where the variances of the readings were estimated: how many lie within the uncertainty of the
  /// prediction and their own together.
  std::optional<ReadingCoverage> readings;
  /// Conventions on which the volumetric error depends other than by the choice of the workpiece datum: the readings
  /// do not determine it in these directions.
  std::vector<std::string> open;
  std::vector<std::size_t> open_constraints;  ///< their indices in the gauge report
  bool open_known = false;                    ///< whether that was looked for
  std::size_t open_rank = 0;                  ///< number of independent displacements among them
  double open_rms = 0;  ///< simulation: root mean square of the part of the volumetric error that lies in them, mm
  SampleStatistics before_statistics, after_statistics, uncertainty_statistics;
};

/// Validation at poses that were not used.
///
/// Whether the volumetric error depends on directions that the readings leave open is found for all. Simulated,
/// trackers only: what the trackers would read at random poses. Simulated, any instruments: the volumetric error there,
/// after the best fit of the workpiece datum, against the truth; uncertainty and coverage are those of the part that
/// the readings determine (verify/parts/determined_part.h), what lies in open directions is told apart. Measured:
/// readings held out of the fit (their lengths; angles take no part).
/// @param poses  number of random poses compared with the truth
UnseenPoses evaluate_unseen(const Study& study, const StudyResult& result, std::size_t poses = 1000);

/// A sentence about the open directions. @pre there are some
std::string open_directions_text(const UnseenPoses& unseen);

}  // namespace abbe
