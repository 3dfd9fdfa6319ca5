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
  EvaluationReport report;
  report.kind = "spindle-distortion";
  report.title = "Thermal distortion by the rotating spindle: " + file;
  report.standard = "ISO 230-3:2020";
  const WarmingRun& run = distortion.run;
  report.facts = {{"rotation", duration_words(run.stop - run.start)}};
  if (run.has_cooling()) report.facts.emplace_back("cooling", duration_words(run.end - run.stop));
  report.facts.emplace_back("displacements and angles", std::to_string(distortion.sensors.size()));
  report.details = nlohmann::ordered_json::object();
  report.details["rotation_s"] = run.stop - run.start;
  report.details["cooling_s"] = run.end - run.stop;
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
