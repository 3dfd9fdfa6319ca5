#include "abbe/formats/machine/correction_limits.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "abbe/compensate/correction_uncertainty.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/geometry/angle_units.h"

namespace abbe {

double refusal_limit(const char* option, const std::optional<double>& limit, const char* unit) {
  if (!limit) return std::numeric_limits<double>::infinity();
  if (!(*limit > 0) || !std::isfinite(*limit)) {
    throw InputError({.field = option}, fmt::format("{:g} is not a limit", *limit),
                     fmt::format("a number above zero in {}, or no limit at all", unit));
  }
  return *limit;
}

void check_refusal(const std::optional<double>& limit_mm, const std::optional<double>& limit_rad,
                   double least_reduction) {
  if (limit_mm) refusal_limit("--limit-um", 1e3 * *limit_mm, "um");
  if (limit_rad) refusal_limit("--limit-urad", 1e6 * *limit_rad, "urad");
  if (!(least_reduction >= 0 && least_reduction <= 1)) {
    throw InputError({.field = "--least-reduction-percent"}, "out of range", "0 to 100 %");
  }
}

void check_largest_turn(double largest_turn) {
  if (!(largest_turn > 0 && largest_turn <= 10 * kDegree))
    throw InputError({.field = "--largest-turn-deg"}, "out of range", "more than 0 and at most 10 degrees");
}

void check_leave_out(double factor, const ErrorSet& errors, const Eigen::MatrixXd& covariance,
                     const std::string& file) {
  const char* const option = "--leave-out-below-uncertainty";
  if (!(factor >= 0 && factor <= 1000)) {
    throw InputError({.field = option}, "out of range", "0 to 1000 standard uncertainties");
  }
  if (factor > 0 && covariance.size() == 0 && stated_variances(errors).size() == 0) {
    throw InputError({.file = file}, "no standard uncertainties are stated", fmt::format("some, for {}", option));
  }
}

}  // namespace abbe
