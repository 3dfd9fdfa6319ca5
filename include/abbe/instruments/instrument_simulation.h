#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "abbe/instruments/instrument.h"

namespace abbe {

struct InstrumentSimulationOptions {
  std::uint64_t seed = 1;
  double noise_factor = 1;      ///< times the noise of the data or the instrument; 0: none
  double outlier_fraction = 0;  ///< of the readings
  double outlier_mm =
      1;  ///< every component of an outlier is shifted by 0.5 to 1.5 times this, angles by 1e-3 rad per mm
  double interval_s = 2;  ///< time between readings, where the plan has none
  /// So many readings in a row are of one pose and of the same items every time; 0: not known. Trackers count their
  /// random numbers by pose and sight, so that a sight more or less leaves those of the other poses as they are.
  std::size_t readings_per_pose = 0;
  bool line_of_sight = true;                                          ///< leave out what cannot be seen
  int threads = 0;                                                    ///< 0: all
  std::function<void(std::size_t done, std::size_t total)> progress;  ///< in poses; called from one thread at a time
};

struct SimulatedInstrument {
  InstrumentReadings readings;
  std::vector<std::uint32_t> outliers;  ///< readings made to outliers
  std::size_t hidden = 0;               ///< readings of the plan left out for lack of a line of sight
};

/// What an instrument would read on a machine with these errors; its quantities are taken as true.
///
/// Noise is normal with the standard uncertainty of the plan where it states one, else of the instrument; that of a
/// reading depends on (seed, reading) only.
/// @param plan  poses, items and inputs; nothing measured
/// @throws std::invalid_argument as check_readings()
SimulatedInstrument simulate_instrument(const Machine& machine, const ErrorSet& errors,
                                        const std::shared_ptr<const Instrument>& instrument, InstrumentReadings plan,
                                        const InstrumentSimulationOptions& options);

}  // namespace abbe
