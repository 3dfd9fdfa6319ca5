#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "abbe/errors/error_set.h"
#include "abbe/identify/covariance.h"

namespace abbe {

enum class DistrustKind {
  misfit,            ///< chi-square too large for chance
  worse_held_out,    ///< the error at poses not used is larger after the correction than before, and not by chance
  no_improvement,    ///< the same, but chance may explain it: the correction is of no use
  implausible_size,  ///< an error larger than any machine in use has
  region_left_out    ///< a robust loss throws out most readings of a region, a station, a reflector or a time
};

/// "misfit", "worse held out", ... as written in files.
const char* kind_text(DistrustKind kind);

/// One reason why the result of an identification must not be used without a look at its cause.
struct Distrust {
  DistrustKind kind = DistrustKind::misfit;
  std::string text;                                     ///< one sentence for people, with its figures
  std::vector<std::pair<std::string, double>> numbers;  ///< the same figures for programs, the unit in the name
};

/// A chi-square is no chance if it lies beyond its quantile of this probability, on either side.
inline constexpr double kNoChance = 1e-6;

/// Residuals larger than the stated uncertainties explain: a chi-square that is exceeded with less than kNoChance.
std::optional<Distrust> distrust_of_fit(const FitStatistics& fit);

/// A warning if the stated uncertainties of the readings are too large: chi-square below what 1 - kNoChance exceed, and
/// residuals smaller by 5 % or more (what a robust loss leaves out of chi-square is less). Empty: none.
std::string warning_of_overstated_noise(const FitStatistics& fit);

/// Errors at poses that took no part in the fit, before and after the correction with the identified errors.
struct HeldOutErrors {
  std::vector<double> before, after;  ///< length at each pose or reading, the same ones in the same order, mm
  /// Sum over them of the variance that the covariance of the estimates gives a prediction, scaled to the residuals of
  /// the fit, mm^2.
  double predicted_square = 0;
  bool readings = true;      ///< the lengths are residuals and have the noise of readings in them; else true errors
  double numbers = 0;        ///< numbers compared, such as three per point
  double fitted_before = 0;  ///< numbers of the set-up that were fitted to these very readings before, not after
};

/// The errors after are larger than before in root mean square.
///
/// They are worse_held_out if the noise and the uncertainty of the identified errors do not explain that: if model and
/// noise are right, that is said of an error-free machine with a probability of kNoChance at most, and of one with
/// errors more rarely. Else they are no_improvement. Derivation in docs/identification.md.
std::optional<Distrust> distrust_of_held_out(const HeldOutErrors& errors);

/// Sizes beyond which an error is taken for a fault of the input: a wrong axis, unit, reflector or sign.
///
/// They are far above what the worst machines in use have, because a machine that is merely bad must pass. Reasons in
/// docs/identification.md.
struct PlausibleSizes {
  double position = 0;                             ///< location error of an axis line and mean of an error motion, mm
  double angle = 0;                                ///< the same, and any rotation, rad
  double motion = 0;                               ///< translation of an error motion about its mean, mm
  double reversal_length = 0, reversal_angle = 0;  ///< mm, rad
};

/// Limits of one axis, which grow with the size of the machine (that of its travels and of its axis points).
PlausibleSizes plausible_sizes(const Machine& machine, std::size_t axis);

/// Every error above its limit, in the order of the set; one reason each.
std::vector<Distrust> distrust_of_sizes(const Machine& machine, const ErrorSet& errors);

}  // namespace abbe
