#include "abbe/instruments/instrument_simulation.h"

#include "abbe/errors/random_stream.h"
#include "abbe/instruments/instrument_observations.h"

namespace abbe {

SimulatedInstrument simulate_instrument(const Machine& machine, const ErrorSet& errors,
                                        const std::shared_ptr<const Instrument>& instrument, InstrumentReadings plan,
                                        const InstrumentSimulationOptions& options) {
  check_readings(machine, *instrument, plan, false);
  const std::size_t rows = instrument->components().size(), count = plan.count();
  // Modelled values are measured minus deviation, whatever is put in as measured.
  if (plan.drift && plan.time_s.empty()) {
    for (std::size_t k = 0; k < count; ++k) plan.time_s.push_back(options.interval_s * static_cast<double>(k));
  }
  InstrumentReadings blank = plan;
  blank.measured.assign(rows, std::vector<double>(count, 0.0));
  blank.uncertainty.assign(rows, std::vector<double>(count, 1.0));
  SimulatedInstrument result;
  result.readings = std::move(plan);
  result.readings.measured = InstrumentObservations(machine, errors, instrument, std::move(blank)).modelled();
  if (result.readings.time_s.empty()) {
    for (std::size_t k = 0; k < count; ++k) {
      result.readings.time_s.push_back(options.interval_s * static_cast<double>(k));
    }
  }
  const InstrumentReadings exact = result.readings;
  for (std::size_t k = 0; k < count; ++k) {
    RandomStream random(options.seed, k);
    const bool outlier = random.uniform() < options.outlier_fraction;
    if (outlier) result.outliers.push_back(static_cast<std::uint32_t>(k));
    for (std::size_t row = 0; row < rows; ++row) {
      const double u =
          exact.uncertainty.empty() ? instrument->standard_uncertainty(exact, k, row) : exact.uncertainty[row][k];
      double& value = result.readings.measured[row][k];
      value += options.noise_factor * u * random.normal();
      const double size = options.outlier_mm * (instrument->components()[row].is_angle ? 1e-3 : 1.0);
      const double sizes = random.uniform(0.5, 1.5), side = random.uniform() < 0.5 ? -1 : 1;
      const double shift = sizes * size * side;
      if (outlier) value += shift;
    }
  }
  return result;
}

}  // namespace abbe
