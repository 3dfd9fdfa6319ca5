#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "abbe/verify/thermal/warming.h"

namespace abbe {

/// One cycle of a test: all poses of a measurement, read once.
struct LocationCycle {
  double from = 0, to = 0;  ///< s: its first and last reading
  double time = 0;          ///< s: mean of the times of its readings, to which its location errors belong
  std::size_t readings = 0;
  double chi_square = 0;  ///< of its readings with its location errors
  double degrees_of_freedom = 0;
};

/// A location error in every cycle.
struct LocationSeries {
  std::string name;                 ///< "EX0C"
  bool is_angle = false;            ///< rad if true, mm if false
  std::vector<double> values;       ///< [cycles] mm or rad
  std::vector<double> uncertainty;  ///< [cycles] standard, by the noise of the readings of the cycle
};

/// Location errors identified in each cycle of a test, all other errors held.
struct LocationErrorsOverTime {
  std::vector<LocationCycle> cycles;  ///< in the order of time, two at least
  std::vector<LocationSeries> locations;
  std::vector<TimeSeries> temperatures;  ///< [cycles] means of the measured states in degC
  std::size_t common_parameters = 0;     ///< found from all readings together and held in the cycles
  double pause = 0;                   ///< s: shortest time without a reading between two cycles; 0: cycles of a length
  std::vector<std::string> left_out;  ///< cycles that are not among them, a sentence each
};

/// Thermal distortion of location errors. Definitions: docs/evaluate-thermal.md.
struct LocationDistortion {
  WarmingRun run;
  std::vector<LocationCycle> cycles;
  std::vector<WarmingSensor> locations{};  ///< the uncertainty of a reading is the largest of its cycles
  std::vector<double> no_change{};         ///< [locations] probability of so large changes by noise alone
  std::vector<TimeSeries> temperatures;
  double chi_square = 0;          ///< of all cycles
  double degrees_of_freedom = 0;  ///< 0: there are none left, nothing is known of the fit
  double misfit_probability = 1;  ///< of so large a chi-square if nothing but the location errors changed
  /// What the stated uncertainties were multiplied by: sqrt(chi-square / degrees of freedom), at least 1.
  double uncertainty_factor = 1;
};

}  // namespace abbe
