#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "abbe/report/evaluations/thermal_figures.h"
#include "abbe/report/evaluations/thermal_report.h"
#include "abbe/report/evaluations/warming_report.h"

namespace abbe {
namespace {

constexpr WarmingWords kLocationWords = {"heating", "location error", "of the axes over the test", "Displacement",
                                         "Tilt"};
/// A change that noise makes with more than this probability is none.
constexpr double kNoiseAlone = 0.01;

void add_cycles(const LocationDistortion& distortion, EvaluationReport& report) {
  EvaluationTable table{
      "Cycles", {"cycle", "begins after", "lasts", "readings", "chi-square / degrees of freedom"}, {}};
  nlohmann::ordered_json cycles = nlohmann::ordered_json::array();
  const double first = distortion.cycles.front().from;
  for (const LocationCycle& cycle : distortion.cycles) {
    table.rows.push_back(
        {std::to_string(table.rows.size() + 1), fmt::format("{:.1f} min", (cycle.from - first) / 60),
         fmt::format("{:.1f} min", (cycle.to - cycle.from) / 60), std::to_string(cycle.readings),
         cycle.degrees_of_freedom > 0 ? fmt::format("{:.2f}", cycle.chi_square / cycle.degrees_of_freedom) : "-"});
    cycles.push_back({{"from_s", cycle.from},
                      {"to_s", cycle.to},
                      {"time_s", cycle.time},
                      {"readings", cycle.readings},
                      {"chi_square", cycle.chi_square},
                      {"degrees_of_freedom", cycle.degrees_of_freedom}});
  }
  report.tables.push_back(std::move(table));
  report.details["cycles"] = std::move(cycles);
}

/// The values of every cycle, and whether noise alone explains that they differ.
void add_values(const LocationDistortion& distortion, EvaluationReport& report) {
  std::string unchanged;
  nlohmann::ordered_json& entries = report.details["locations"];
  for (std::size_t i = 0; i < distortion.locations.size(); ++i) {
    const ThermalSensor& sensor = distortion.locations[i].sensor;
    nlohmann::ordered_json values = nlohmann::ordered_json::array();
    const double micro = sensor.is_angle ? 1e6 : 1e3;
    for (const double value : sensor.series.values) values.push_back(micro * value);
    const char* const unit = sensor.is_angle ? "_urad" : "_um";
    entries[i][fmt::format("values{}", unit)] = std::move(values);
    entries[i][fmt::format("standard_uncertainty{}", unit)] = micro * sensor.reading_uncertainty;
    entries[i]["probability_of_no_change"] = distortion.no_change[i];
    if (distortion.no_change[i] > kNoiseAlone) unchanged += (unchanged.empty() ? "" : ", ") + sensor.series.name;
  }
  if (unchanged.empty()) return;
  report.notes.push_back("No change beyond the noise of the readings: " + unchanged +
                         ". The range of values that only scatter is not zero.");
}

void add_fit(const LocationDistortion& distortion, EvaluationReport& report) {
  report.details["fit"] = {{"chi_square", distortion.chi_square},
                           {"degrees_of_freedom", distortion.degrees_of_freedom},
                           {"probability", distortion.misfit_probability},
                           {"uncertainty_factor", distortion.uncertainty_factor}};
  if (!(distortion.degrees_of_freedom > 0)) {
    report.notes.push_back(
        "The readings determine what was found and nothing more: whether other errors changed is not known.");
  } else if (distortion.uncertainty_factor > 1) {
    report.notes.push_back(fmt::format(
        "Residuals are {:.2f} times as large as the uncertainties of the readings that the study states; uncertainties "
        "are multiplied by that.",
        distortion.uncertainty_factor));
  }
}

}  // namespace

EvaluationReport location_distortion_report(const std::string& file, const LocationDistortion& distortion, double pause,
                                            const std::vector<std::string>& left_out) {
  const WarmingRun& run = distortion.run;
  EvaluationReport report = begun_warming_report("location-distortion",
                                                 "Thermal distortion of location errors: " + file, kLocationWords, run);
  report.facts.emplace_back("cycles", std::to_string(distortion.cycles.size()));
  report.facts.emplace_back("location errors", std::to_string(distortion.locations.size()));
  if (pause > 0) report.facts.emplace_back("a cycle begins after a pause of more than", duration_words(pause));
  for (const WarmingSensor& one : distortion.locations) {
    add_warming_figures(one, run.has_cooling(), kLocationWords, report);
  }
  add_thermal_notes(true, false, {&distortion.locations.front().sensor.series}, report);
  report.notes.push_back(
      "The other errors of the machine are held at their values from all readings and are not included in the "
      "uncertainties, which are those of changes. Open quantities of a set-up are found again in every cycle.");
  report.notes.insert(report.notes.end(), left_out.begin(), left_out.end());
  add_warming_sensors(distortion.locations, kLocationWords, "locations", report);
  add_fit(distortion, report);
  add_values(distortion, report);
  add_cycles(distortion, report);
  add_warming_plots(run, distortion.locations, distortion.temperatures, kLocationWords, report);
  return report;
}

}  // namespace abbe
