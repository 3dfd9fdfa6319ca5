#include <fmt/format.h>

#include <array>
#include <cmath>
#include <utility>

#include "abbe/formats/files/file_name.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/identify/trust/trust.h"
#include "abbe/report/evaluations/thermal_report.h"
#include "abbe/study/evaluations/evaluated.h"
#include "abbe/study/evaluations/location_cycles.h"

namespace abbe {
namespace {

double minutes(double seconds) { return seconds / 60; }

/// The times of heating, as stated or from the first to the last cycle.
WarmingRun heating_of(const LocationDistortionTest& test, const LocationErrorsOverTime& found,
                      const std::string& file) {
  const LocationCycle &first = found.cycles.front(), &last = found.cycles.back();
  const bool has_start = !std::isnan(test.start), has_stop = !std::isnan(test.stop);
  // What is stated lies between readings; the values of the cycles belong to the means of their times.
  const WarmingRun run{has_start ? test.start : first.time, has_stop ? test.stop : last.time, last.time};
  const char* const option = has_stop ? "--stop-min" : "--start-min";
  if (!(run.stop > run.start)) {
    throw InputError(
        {.file = file, .field = option},
        fmt::format("the heating stops at {:.6g} min and starts at {:.6g} min", minutes(run.stop), minutes(run.start)),
        "a stop after the start, on the time scale of the readings");
  }
  if (run.start >= first.from && run.start <= last.to && run.stop <= last.to) return run;
  throw InputError({.file = file, .field = run.stop > last.to ? "--stop-min" : "--start-min"},
                   fmt::format("the cycles were read from {:.6g} to {:.6g} min", minutes(first.from), minutes(last.to)),
                   "times of the heating between them");
}

}  // namespace

std::span<const TestNumber<LocationDistortionTest>> location_distortion_numbers() {
  using Test = LocationDistortionTest;
  static constexpr double kMost = 1e7;
  static constexpr auto numbers = std::to_array<TestNumber<Test>>({
      {"--cycle-min", &Test::cycle, 60, 1e-3, kMost,
       "Time from one cycle to the next; default: a long pause begins a cycle"},
      {"--pause-min", &Test::pause, 60, 1e-6, kMost,
       "A longer time without a reading begins a cycle; default: found from the times"},
      {"--start-min", &Test::start, 60, -kMost, kMost,
       "The machine begins to be heated, by the time of the readings; default: first cycle"},
      {"--stop-min", &Test::stop, 60, -kMost, kMost, "The heating stops; default: last cycle"},
  });
  return numbers;
}

Evaluation evaluated(const LocationDistortionTest& test, const std::string& file) {
  if (!std::isnan(test.cycle) && !std::isnan(test.pause)) {
    throw InputError({.field = "--pause-min"}, "has no effect beside --cycle-min", "one of them");
  }
  require_readings(test.campaign.reading_count() > 0, file);
  const auto stated = [](double value) { return std::isnan(value) ? 0 : value; };
  const LocationErrorsOverTime found =
      location_errors_over_time(test.study, test.campaign, {stated(test.cycle), stated(test.pause)}, file);
  LocationDistortion distortion = evaluate_location_distortion(found, heating_of(test, found, file));
  Evaluation result;
  result.report = location_distortion_report(file_name(file), distortion, found.pause, found.left_out);
  if (distortion.misfit_probability < kNoChance) {
    result.refused = fmt::format(
        "changes of the location errors do not explain the readings (chi-square / degrees of freedom {:.3g}): other "
        "errors changed too, or the readings are less certain than the study states",
        distortion.chi_square / distortion.degrees_of_freedom);
    result.report.notes.insert(result.report.notes.begin(), "Not to be used as it is: " + result.refused + ".");
  }
  result.found = std::move(distortion);
  return result;
}

}  // namespace abbe
