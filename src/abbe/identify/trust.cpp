#include "abbe/identify/trust.h"

#include <fmt/format.h>

#include <cmath>

namespace abbe {
namespace {

constexpr double kWorthTelling = 0.95;  // residuals / stated uncertainties

}  // namespace

const char* kind_text(DistrustKind kind) {
  constexpr const char* kNames[] = {"misfit", "worse held out", "implausible size", "region left out"};
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
      "with "
      "{:.0f} degrees of freedom, probability above 1 - {:.0e}): the readings are more certain than stated, or they "
      "are "
      "not independent, such as rows that stand twice. The stated uncertainties of the result do not fit them.",
      ratio, fit.chi_square, fit.degrees_of_freedom, kNoChance);
}

std::optional<Distrust> distrust_of_held_out(const HeldOutErrors& errors) {
  const double independent = errors.count - errors.fitted_before;
  if (!(independent > 0)) return {};
  const double allowed = std::sqrt(errors.count / independent) * errors.mean_before;
  if (!(errors.mean_after > allowed)) return {};
  return Distrust{DistrustKind::worse_held_out,
                  fmt::format("at poses that took no part in the fit the mean error is {:.4g} um after the correction "
                              "and {:.4g} um before: the identified errors make the machine worse",
                              1e3 * errors.mean_after, 1e3 * errors.mean_before),
                  {{"mean_before_um", 1e3 * errors.mean_before}, {"mean_after_um", 1e3 * errors.mean_after}}};
}

}  // namespace abbe
