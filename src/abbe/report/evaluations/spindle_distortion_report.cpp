#include <nlohmann/json.hpp>

#include "abbe/report/evaluations/thermal_figures.h"
#include "abbe/report/evaluations/thermal_report.h"
#include "abbe/report/evaluations/warming_report.h"

namespace abbe {
namespace {

constexpr WarmingWords kSpindleWords = {"rotation", "sensor", "by the rotating spindle", "Distortion", "Tilt"};

}  // namespace

EvaluationReport spindle_distortion_report(const std::string& file, const SpindleDistortion& distortion,
                                           bool lacks_distance) {
  const WarmingRun& run = distortion.run;
  EvaluationReport report = begun_warming_report(
      "spindle-distortion", "Thermal distortion by the rotating spindle: " + file, kSpindleWords, run);
  report.facts.emplace_back("displacements and angles", std::to_string(distortion.sensors.size()));
  bool is_stated = false;
  std::vector<const TimeSeries*> all;
  for (const WarmingSensor& one : distortion.sensors) {
    add_warming_figures(one, run.has_cooling(), kSpindleWords, report);
    is_stated = is_stated || one.sensor.reading_uncertainty > 0;
    all.push_back(&one.sensor.series);
  }
  add_thermal_notes(is_stated, lacks_distance, all, report);
  report.notes.push_back(
      "Uncertainties of time constants are those of the fit, from its residuals or from the stated uncertainty of a "
      "reading, whichever is larger.");
  add_warming_sensors(distortion.sensors, kSpindleWords, "sensors", report);
  add_warming_plots(run, distortion.sensors, distortion.temperatures, kSpindleWords, report);
  return report;
}

}  // namespace abbe
