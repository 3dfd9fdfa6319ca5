#pragma once

// A whole study, as `abbe run` does it:
//
//   #include <abbe/study/run_study.h>
//
//   #include <cstdio>
//
//   int main() {
//     abbe::Study study = abbe::read_study("examples/three_axis/interferometer.study.toml");
//     study.output = "results";
//     const abbe::StudyResult result = abbe::run_study(study);
//     abbe::write_results(study, result);          // errors.toml, report.html and more
//     if (abbe::says_no(study, result)) return 1;  // abbe::study_text() says why
//
//     std::printf("%zu readings: %s\n", result.campaign.reading_count(), result.identification.message.c_str());
//     const abbe::VolumetricFigures& volumetric = result.volumetric.value();
//     std::printf("mean volumetric error over %s:\n", volumetric.poses_words.c_str());
//     std::printf("%.2f um before, %.2f um after correction (k = 2)\n", 1e3 * volumetric.predicted_before->mean,
//                 1e3 * volumetric.predicted_after->mean);
//     return 0;
//   }
//
// It prints:
//
//   486 readings: converged
//   mean volumetric error over 9 x 9 x 9 poses over X 0 to 760 mm, Y 0 to 440 mm, Z -460 to 0 mm:
//   6.82 um before, 0.81 um after correction (k = 2)
//
// study holds whole jobs, each a function from a request to a result:
//   run_study.h, study_result.h         readings to errors to maps; study_steps.h has the steps
//   results.h, study_text.h, trust.h    the results folder, the result for people, whether it may be used
//   planning.h, plan_text.h             `abbe plan`: which readings to take
//   verification.h, errors_map.h        `abbe verify`, `abbe map`; verified_readings.h: `abbe verify --readings`
//   corrected_program.h                 `abbe compensate gcode`
//   corrected_commands.h                `abbe compensate poses`; frozen_errors.h: `abbe compensate freeze`
//   planned_path.h, planned_scan.h      `abbe path`, `abbe scan plan`
//   found_positions.h                   `abbe position`
//   scan_registration.h                 `abbe register`; scan_deviations.h: `abbe deviate`
//   fitted_points.h                     `abbe fit`

#include <cstddef>
#include <functional>
#include <stop_token>

#include "abbe/formats/study/study_file.h"
#include "abbe/geometry/stopped.h"
#include "abbe/study/identification/trust.h"
#include "abbe/study/report/results.h"
#include "abbe/study/report/study_text.h"
#include "abbe/study/study_result.h"

namespace abbe {

/// The parts of a study that take time, in their order.
enum class StudyStep { gather, identify, map };

/// "simulating readings" or "reading measurements", "identifying", "mapping the volumetric error".
const char* step_words(const Study& study, StudyStep step);

/// Options of a run, besides the study file.
struct RunOptions {
  bool accept_misfit = false;  ///< the result is to be used although it is distrusted; its errors file says so
  bool map = true;             ///< false: no map of the volumetric error
  bool advice = true;          ///< false: not computed is which measurement would show what these readings leave open
  /// Called at the beginning of every step and during it, one call at a time but from any thread: done of total.
  std::function<void(StudyStep step, std::size_t done, std::size_t total)> progress{};
  std::stop_token stop{};  ///< looked at during every step
  /// Who sums the readings for the identification; empty: this process. Trials of orders, whose models are others, and
  /// everything after the identification are computed in this process.
  Summation summation{};
  /// Who computes the samples of a Monte Carlo and the poses of the map; empty: this process.
  WorkDriver work{};
};

/// Reads or simulates the readings of a study, identifies, validates at poses that were not used, judges whether the
/// result may be trusted, and maps the volumetric error. Files are read, none is written: write_results() does that.
///
/// @throws InputError naming file, line and field; Stopped where that was asked for
StudyResult run_study(const Study& study, const RunOptions& options = {});

}  // namespace abbe
