#include "compensate/safety.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "abbe/compensate/correction_uncertainty.h"
#include "abbe/formats/input_error.h"
#include "abbe/geometry/angle_units.h"
#include "compensate/position_words.h"

namespace abbe {
double refusal_limit(const char* option, const std::optional<double>& given, const char* unit) {
  if (!given) return std::numeric_limits<double>::infinity();
  if (!(*given > 0) || !std::isfinite(*given)) {
    throw InputError({.field = option}, fmt::format("{:g} is not a limit", *given),
                     fmt::format("a number above zero in {}, or no limit at all", unit));
  }
  return *given;
}

double largest_turn_option(double degrees) {
  if (!(degrees > 0 && degrees <= 10))
    throw InputError({.field = "--largest-turn-deg"}, "out of range", "more than 0 and at most 10 degrees");
  return degrees * kDegree;
}

void check_leave_out(double factor, const ErrorsFile& errors, const std::string& file) {
  const char* const option = "--leave-out-below-uncertainty";
  if (!(factor >= 0 && factor <= 1000)) {
    throw InputError({.field = option}, "out of range", "0 to 1000 standard uncertainties");
  }
  if (factor > 0 && errors.covariance.size() == 0 && stated_variances(errors.errors).size() == 0) {
    throw InputError({.file = file}, "no standard uncertainties are stated", fmt::format("some, for {}", option));
  }
}

std::string left_out_text(const Machine& machine, double factor, const LeftOutErrors& left_out, const char* indent) {
  const auto listed = [](const std::vector<std::string>& names) {
    return names.empty() ? std::string("none") : fmt::format("{}", fmt::join(names, ", "));
  };
  std::string text = fmt::format("{}left out, below {:g} standard uncertainties everywhere: {}\n", indent, factor,
                                 listed(left_out.names));
  if (!left_out.kept.empty()) {
    text += fmt::format("{}kept, as they are below it by themselves but not together with others: {}\n", indent,
                        listed(left_out.kept));
  }
  if (left_out.where.empty()) return text;
  return text +
         fmt::format("{}what is left out shifts the functional point by at most {:.3f} um over the travel, at {}\n",
                     indent, 1e3 * left_out.largest_shift, position_words(machine, left_out.where));
}

void state_left_out(const Machine& machine, const LeftOutErrors& left_out, nlohmann::ordered_json& json) {
  json["left_out"] = left_out.names;
  json["left_out_kept"] = left_out.kept;
  json["left_out_largest_um"] = 1e3 * left_out.largest_shift;
  if (!left_out.where.empty()) json["left_out_largest_at"] = position_json(machine, left_out.where);
}

}  // namespace abbe
