#include "abbe/identify/trust/trust.h"

#include <fmt/format.h>

#include <cmath>
#include <numeric>

#include "abbe/identify/distributions.h"

namespace abbe {
namespace {

constexpr double kWorthTelling = 0.95;  // residuals / stated uncertainties
// Readings without noise of a machine without errors leave rounding, which is neither better nor worse: mm.
constexpr double kNoError = 1e-6;

double sum_of_squares(const std::vector<double>& values) {
  return std::inner_product(values.begin(), values.end(), values.begin(), 0.0);
}

double root_mean_square(const std::vector<double>& values) {
  return values.empty() ? 0 : std::sqrt(sum_of_squares(values) / static_cast<double>(values.size()));
}

bool is_rounding(const HeldOutErrors& errors) { return !(root_mean_square(errors.after) > kNoError); }

/// docs/identification.md, "Worse held out": the three allowances share the probability.
bool is_worse_by_no_chance(const HeldOutErrors& errors) {
  constexpr double kShare = kNoChance / 3;
  const double independent = errors.numbers - errors.fitted_before;
  if (errors.before.size() != errors.after.size() || !(independent > 0) || is_rounding(errors)) return false;
  const double before = sum_of_squares(errors.before), after = sum_of_squares(errors.after);
  const double by_estimates = errors.predicted_square * chi_square_quantile(kShare, 1);
  const double variance = before / independent;
  if (!errors.readings) return after > by_estimates && after > errors.numbers * variance;
  // The variance comes from the same readings, of what the fit left: Fisher's F and not chi-square.
  const double by_fit = errors.fitted_before > 0 ? errors.fitted_before * variance *
                                                       fisher_quantile(kShare, errors.fitted_before, independent)
                                                 : 0.0;
  // What is left has to be more than the product of noise and estimates comes to, whose spread the readings show.
  std::vector<double> growth(errors.after.size());
  for (std::size_t k = 0; k < growth.size(); ++k) {
    growth[k] = errors.after[k] * errors.after[k] - errors.before[k] * errors.before[k];
  }
  return sum_exceedance(growth, by_estimates + by_fit) < kShare;
}

}  // namespace

const char* kind_text(DistrustKind kind) {
  constexpr const char* kNames[] = {"misfit", "worse held out", "no improvement", "implausible size",
                                    "region left out"};
  return kNames[static_cast<int>(kind)];
}

std::optional<Distrust> distrust_of_fit(const FitStatistics& fit) {
  if (!(fit.degrees_of_freedom > 0) || !(fit.variance_factor > 1) || !(fit.p_value < kNoChance)) return {};
  const double ratio = std::sqrt(fit.variance_factor);
  return Distrust{
      DistrustKind::misfit,
      fmt::format("the residuals are {:.3g} times as large as the stated uncertainties of the readings explain "
                  "(chi-square {:.4g} with {:.0f} degrees of freedom, probability below {:.0e}): the model lacks "
                  "errors that the readings show, a number of the set-up or of the machine is wrong, or the readings "
                  "are less certain than stated. The stated uncertainties of the result are too small",
                  ratio, fit.chi_square, fit.degrees_of_freedom, kNoChance),
      {{"chi_square", fit.chi_square},
       {"degrees_of_freedom", fit.degrees_of_freedom},
       {"probability", fit.p_value},
       {"normalised_residual_rms", ratio}}};
}

std::string warning_of_overstated_noise(const FitStatistics& fit) {
  if (!(fit.degrees_of_freedom > 0) || !(1 - fit.p_value < kNoChance)) return {};
  const double ratio = std::sqrt(fit.variance_factor);
  if (!(ratio < kWorthTelling)) return {};
  return fmt::format(
      "the residuals are only {:.3g} times as large as the stated uncertainties of the readings (chi-square {:.4g} "
      "with {:.0f} degrees of freedom, probability above 1 - {:.0e}): the readings are more certain than stated, or "
      "they are not independent, such as duplicate rows. The stated uncertainties of the result do not fit "
      "them.",
      ratio, fit.chi_square, fit.degrees_of_freedom, kNoChance);
}

std::optional<Distrust> distrust_of_held_out(const HeldOutErrors& errors) {
  const double before = 1e3 * root_mean_square(errors.before), after = 1e3 * root_mean_square(errors.after);
  const bool worse = is_worse_by_no_chance(errors);
  if (is_rounding(errors) || !(worse || after > before)) return {};
  const std::string why =
      worse ? fmt::format(
                  "which neither noise nor the uncertainty of the identified errors explains (probability "
                  "below {:.0e}): the identified errors make the machine worse",
                  kNoChance)
            : "so the correction shows no improvement. Noise and the uncertainty of the identified errors may explain "
              "that, as on a machine whose errors are smaller than these";
  return Distrust{
      worse ? DistrustKind::worse_held_out : DistrustKind::no_improvement,
      fmt::format("at poses that were not used in the fit, the root mean square error is {:.4g} um after the "
                  "correction and {:.4g} um before, {}",
                  after, before, why),
      {{"rms_before_um", before},
       {"rms_after_um", after},
       {"predicted_rms_um", 1e3 * std::sqrt(errors.predicted_square / static_cast<double>(errors.after.size()))}}};
}

}  // namespace abbe
