#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <string>

#include "abbe/errors/random_errors.h"
#include "abbe/instruments/instrument_observations.h"
#include "abbe/instruments/instrument_simulation.h"
#include "abbe/instruments/measurement_plan.h"

/// What every instrument has to satisfy, whatever it measures.
namespace abbe::test {

/// Errors of realistic size with everything in them, the tool offset error too.
inline ErrorSet some_errors(const Machine& machine, std::uint64_t seed = 7) {
  RandomErrorOptions options;
  options.seed = seed;
  options.constant_terms = true;
  ErrorSet errors = random_errors(machine, options);
  errors.tool_offset_error = {0.011, -0.007, 0.005};
  return errors;
}

/// A plan over the whole travel, all of the first item.
inline InstrumentReadings anywhere(const Machine& machine, std::size_t count) {
  InstrumentReadings plan;
  const PoseList poses = random_plan(machine, full_ranges(machine, 2), count, 4);
  for (std::size_t k = 0; k < poses.count(); ++k) plan.append(poses.pose(k), 0);
  return plan;
}

/// Readings of a plan without noise.
inline InstrumentReadings exact_readings(const Machine& machine, const ErrorSet& errors,
                                         const std::shared_ptr<const Instrument>& instrument,
                                         const InstrumentReadings& plan) {
  InstrumentSimulationOptions options;
  options.noise_factor = 0;
  return simulate_instrument(machine, errors, instrument, plan, options).readings;
}

/// Analytic derivatives by every machine parameter and every unknown against central differences.
/// @param tolerance  of the unweighted derivative, relative where it is above 1
inline void expect_jacobian_equals_differences(const Machine& machine, const ErrorSet& errors,
                                               const std::shared_ptr<const Instrument>& instrument,
                                               const InstrumentReadings& plan, double tolerance = 2e-7) {
  InstrumentReadings readings = exact_readings(machine, errors, instrument, plan);
  const std::size_t rows = instrument->components().size();
  readings.uncertainty.assign(rows, std::vector<double>(readings.count(), 1.0));
  InstrumentObservations observations(machine, errors, instrument, readings);
  const std::size_t count = std::min(readings.count(), Observations::kBlockSize);
  const std::vector<double> start = errors.parameters();
  const std::vector<double> setup = observations.unknown_values();
  std::vector<std::size_t> parameters(start.size()), unknowns(setup.size());
  std::iota(parameters.begin(), parameters.end(), std::size_t{0});
  std::iota(unknowns.begin(), unknowns.end(), std::size_t{0});
  const std::size_t stride = rows * count + 3;
  std::vector<double> residuals(rows * count), jacobian((start.size() + setup.size()) * stride);
  observations.evaluate(0, count, parameters, unknowns, residuals.data(), jacobian.data(), stride);
  for (const double r : residuals) ASSERT_NEAR(r, 0, 1e-10) << "readings without noise leave residuals";

  const std::vector<std::string> names = parameter_names(machine, errors);
  const std::vector<bool> angles = parameters_are_angles(machine, errors);
  std::vector<double> above(rows * count), below(rows * count);
  for (std::size_t column = 0; column < start.size() + setup.size(); ++column) {
    const bool of_machine = column < start.size();
    const SetupUnknown* unknown = of_machine ? nullptr : &observations.unknowns()[column - start.size()];
    const double step = (of_machine ? angles[column] : unknown->is_angle) ? 1e-5 : 1e-3;
    for (double* side : {above.data(), below.data()}) {
      std::vector<double> moved = start, moved_setup = setup;
      double& value = of_machine ? moved[column] : moved_setup[column - start.size()];
      value += side == above.data() ? step : -step;
      observations.set_parameters(moved, moved_setup);
      observations.evaluate(0, count, {}, {}, side, nullptr, 0);
    }
    for (std::size_t i = 0; i < rows * count; ++i) {
      const double difference = (below[i] - above[i]) / (2 * step), analytic = jacobian[column * stride + i];
      ASSERT_NEAR(analytic, difference, tolerance * std::max(1.0, std::abs(analytic)))
          << (of_machine ? names[column] : unknown->name) << ", reading " << i % count << ", component " << i / count;
    }
  }
}

}  // namespace abbe::test
