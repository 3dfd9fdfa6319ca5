#pragma once

// Internal to report: what the reports on machines that are heated and cool have in common.
#include <string>
#include <vector>

#include "abbe/report/evaluations/evaluation_report.h"
#include "abbe/verify/thermal/warming.h"

namespace abbe {

/// What is heated in words.
struct WarmingWords {
  const char* during;     ///< "rotation"
  const char* what;       ///< header of the names: "sensor"
  const char* by;         ///< titles of plots: "by the rotating spindle"
  const char* displaced;  ///< "Distortion"
  const char* turned;     ///< "Tilt"
};

/// A report with what was heated and cooled, in words and for programs. @param title  with the name of the file
EvaluationReport begun_warming_report(const char* kind, const std::string& title, const WarmingWords& words,
                                      const WarmingRun& run);

/// Figures d60_, d_, dcool_ and tau_ of one sensor.
void add_warming_figures(const WarmingSensor& one, bool has_cooling, const WarmingWords& words,
                         EvaluationReport& report);

/// Table of the changes from the start, and `sensors` of the details under this key.
void add_warming_sensors(const std::vector<WarmingSensor>& sensors, const WarmingWords& words, const char* key,
                         EvaluationReport& report);

/// Displacements, angles and temperatures over time.
void add_warming_plots(const WarmingRun& run, const std::vector<WarmingSensor>& sensors,
                       const std::vector<TimeSeries>& temperatures, const WarmingWords& words,
                       EvaluationReport& report);

}  // namespace abbe
