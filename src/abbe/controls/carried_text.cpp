#include "abbe/controls/carried_text.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "abbe/machine/axis_unit.h"

namespace abbe {
namespace {

double as_micro(double value) { return 1e6 * value; }
double as_um(double mm) { return 1e3 * mm; }

/// What becomes of one error, in a word.
const char* carried_word(const CarriedError& error) {
  if (error.effect_before < 1e-9) {
    if (error.turn_before < 1e-12) return "no effect";
    return error.turn_after < 0.05 * error.turn_before ? "carried" : "not carried";
  }
  const double share = error.carried();
  if (share >= 0.95) return "carried";
  return share > 0.05 ? "in part" : "not carried";
}

}  // namespace

std::string micro_words(double value, bool is_angle) {
  return fmt::format("{:.2f} {}", micro_per_unit(is_angle) * value, micro_unit(is_angle));
}

std::string carried_errors_lines(const std::vector<CarriedError>& errors) {
  std::string text;
  for (const CarriedError& error : errors) {
    text +=
        fmt::format("  {:<8} {:>14}  {:<12} {:8.3f} -> {:.3f} um", error.name, micro_words(error.size, error.is_angle),
                    carried_word(error), as_um(error.effect_before), as_um(error.effect_after));
    if (error.turn_before > 1e-12) {
      text += fmt::format(", direction {:.2f} -> {:.2f} urad", as_micro(error.turn_before), as_micro(error.turn_after));
    }
    text += "\n";
  }
  return text;
}

nlohmann::ordered_json carried_error_json(const CarriedError& error) {
  nlohmann::ordered_json one;
  one["name"] = error.name;
  one[std::string("size_") + micro_unit(error.is_angle)] = micro_per_unit(error.is_angle) * error.size;
  one["carried"] = carried_word(error);
  one["rms_before_um"] = as_um(error.effect_before);
  one["rms_after_um"] = as_um(error.effect_after);
  one["direction_rms_before_urad"] = as_micro(error.turn_before);
  one["direction_rms_after_urad"] = as_micro(error.turn_after);
  return one;
}

std::string deviations_line(const char* name, const PoseDeviations& deviations) {
  const SampleStatistics& p = deviations.position_statistics;
  const SampleStatistics& o = deviations.orientation_statistics;
  return fmt::format(
      "  {:<22} mean {:.3f}  95 % {:.3f}  max {:.3f} um;  tool direction mean {:.2f}  95 % {:.2f}  max {:.2f} urad\n",
      name, as_um(p.mean), as_um(p.p95), as_um(p.maximum), as_micro(o.mean), as_micro(o.p95), as_micro(o.maximum));
}

nlohmann::ordered_json deviations_json(const PoseDeviations& deviations) {
  const SampleStatistics& p = deviations.position_statistics;
  const SampleStatistics& o = deviations.orientation_statistics;
  return {{"mean_um", as_um(p.mean)},
          {"rms_um", as_um(p.rms)},
          {"p95_um", as_um(p.p95)},
          {"max_um", as_um(p.maximum)},
          {"direction_mean_urad", as_micro(o.mean)},
          {"direction_p95_urad", as_micro(o.p95)},
          {"direction_max_urad", as_micro(o.maximum)}};
}

}  // namespace abbe
