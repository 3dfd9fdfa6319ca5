#pragma once

#include <cstdint>
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
};

struct SimulatedInstrument {
  InstrumentReadings readings;
  std::vector<std::uint32_t> outliers;  ///< readings made to outliers
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
