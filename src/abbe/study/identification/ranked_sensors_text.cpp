#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "abbe/study/identification/ranked_sensors.h"

namespace abbe {
namespace {

std::string held_out_words(const HeldOutSensors& one) {
  if (!std::isfinite(one.rms)) return "some blocks are not predicted";
  const std::string whitened = fmt::format("{:.3f} standard uncertainties", one.rms);
  return one.length_rms > 0 ? fmt::format("{:.3f} um ({})", 1e3 * one.length_rms, whitened) : whitened;
}

nlohmann::ordered_json held_out_json(const RankedSensors& ranked, const HeldOutSensors& one) {
  nlohmann::ordered_json json;
  json["sensors"] = nlohmann::ordered_json::array();
  for (const std::size_t sensor : one.sensors) json["sensors"].push_back(ranked.names[sensor]);
  if (std::isfinite(one.rms)) {
    json["held_out_rms"] = one.rms;
    json["standard_error_of_mean_square"] = one.standard_error;
  }
  if (one.length_rms > 0) json["held_out_rms_um"] = 1e3 * one.length_rms;
  json["terms"] = one.terms;
  return json;
}

/// The sensor that a set has and the one before it has not.
std::string added_sensor(const RankedSensors& ranked, const HeldOutSensors& before, const HeldOutSensors& now) {
  for (const std::size_t sensor : now.sensors) {
    if (std::find(before.sensors.begin(), before.sensors.end(), sensor) == before.sensors.end())
      return ranked.names[sensor];
  }
  return "";
}

std::string missing_sensor(const RankedSensors& ranked, const HeldOutSensors& one) {
  for (std::size_t s = 0; s < ranked.names.size(); ++s) {
    if (std::find(one.sensors.begin(), one.sensors.end(), s) == one.sensors.end()) return ranked.names[s];
  }
  return "";
}

}  // namespace

std::string ranked_sensors_text(const RankedSensors& ranked) {
  if (!ranked.done) {
    return fmt::format("  sensors: not ranked ({} without terms with states)\n", status_text(ranked.status));
  }
  std::string text =
      fmt::format("  sensors by {} held-out blocks of time (root mean square of their residuals)\n    none: {}{}\n",
                  ranked.blocks, held_out_words(ranked.forward.front()), ranked.enough == 0 ? "   <- enough" : "");
  for (std::size_t k = 1; k < ranked.forward.size(); ++k) {
    text +=
        fmt::format("    {}: {}{}: {}{}\n", k, k > 1 ? "and " : "",
                    added_sensor(ranked, ranked.forward[k - 1], ranked.forward[k]), held_out_words(ranked.forward[k]),
                    k == ranked.enough  ? "   <- enough: within a standard error of the best"
                    : k > ranked.enough ? ", no gain"
                                        : "");
  }
  for (const HeldOutSensors& one : ranked.without) {
    if (ranked.names.size() < 2) break;
    text += fmt::format("    all without {}: {}\n", missing_sensor(ranked, one), held_out_words(one));
  }
  for (const SensorLikeness& one : ranked.alike) {
    text += "    note: " + likeness_words(ranked.courses, one) + "\n";
  }
  return text;
}

std::string ranked_sensors_sentence(const RankedSensors& ranked) {
  std::string words = fmt::format("Sensors by {} held-out blocks of time, root mean square of their residuals: none {}",
                                  ranked.blocks, held_out_words(ranked.forward.front()));
  for (std::size_t k = 1; k < ranked.forward.size(); ++k) {
    words +=
        fmt::format(", {}{} {}", k > 1 ? "and " : "", added_sensor(ranked, ranked.forward[k - 1], ranked.forward[k]),
                    held_out_words(ranked.forward[k]));
  }
  return words + fmt::format("; {} of {} {} enough (within a standard error of the best).", ranked.enough,
                             ranked.names.size(), ranked.enough == 1 ? "is" : "are");
}

nlohmann::ordered_json ranked_sensors_json(const RankedSensors& ranked) {
  nlohmann::ordered_json json;
  json["ranked"] = ranked.done;
  json["sensors"] = ranked.names;
  if (!ranked.done) {
    json["status"] = status_text(ranked.status);
    return json;
  }
  json["blocks_of_time"] = ranked.blocks;
  for (const HeldOutSensors& one : ranked.forward) json["added_in_turn"].push_back(held_out_json(ranked, one));
  for (const HeldOutSensors& one : ranked.without) {
    json["all_but_one"].push_back({{"without", missing_sensor(ranked, one)}, {"result", held_out_json(ranked, one)}});
  }
  json["enough"] = ranked.enough;
  for (const SensorLikeness& one : ranked.alike) json["alike"].push_back(likeness_json(ranked.courses, one));
  return json;
}

}  // namespace abbe
