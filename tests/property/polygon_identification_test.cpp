#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "abbe/errors/random_stream.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/identify/identify.h"
#include "abbe/instruments/instrument_observations.h"
#include "abbe/instruments/instrument_simulation.h"
#include "abbe/instruments/polygon/polygon_gauge.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

constexpr std::size_t kCoefficients = 9;  // constant and four harmonics

ErrorSet table_errors(std::uint64_t seed) {
  RandomStream random(seed);
  ErrorSet errors;
  for (int i = 0; i < kComponentCount; ++i) {
    ErrorMotion motion{0,
                       static_cast<Component>(i),
                       {.kind = BasisKind::fourier, .order = 4, .from = 0, .to = kTurn, .period = kTurn},
                       {},
                       {}};
    for (std::size_t k = 0; k < kCoefficients; ++k) {
      motion.coefficients.push_back(seed == 0 ? 0 : random.uniform(-1, 1) * (i < 3 ? 5e-3 : 10 * kArcsec));
    }
    errors.motions.push_back(motion);
  }
  return errors;
}

/// A prism put on twice, the second time turned by one face; seed 0: without errors.
PolygonGaugeSetup prism(std::uint64_t seed) {
  PolygonGaugeSetup setup;
  setup.polygon = regular_polygon(12, 48.3, 17);
  setup.mounts = {{"mount1", 0}, {"mount2", 1}};
  if (seed == 0) return setup;
  RandomStream random(seed);
  const auto angle = [&](double arcsec) { return random.uniform(-arcsec, arcsec) * kArcsec; };
  const auto length = [&](double um) { return random.uniform(-um, um) * 1e-3; };
  for (PolygonFace& face : setup.polygon.faces) {
    face.azimuth_error = angle(1);
    face.tilt = angle(5);
    face.distance += length(1);
  }
  for (PolygonGaugeSetup::Mount& mount : setup.mounts) {
    for (std::size_t i = 0; i < 6; ++i) mount.numbers[i].value = i < 3 ? angle(20) : length(10);
  }
  return setup;
}

TEST(PolygonIdentification, AMachinesRotaryAxisIsIdentifiedTogetherWithThePrism) {
  const Machine machine = test::rotary_table();
  const ErrorSet truth = table_errors(4);
  const auto actual = std::make_shared<PolygonGauge>(prism(6));
  const auto nominal = std::make_shared<PolygonGauge>(prism(0));
  InstrumentSimulationOptions options;
  options.seed = 9;
  const InstrumentReadings readings =
      simulate_instrument(machine, truth, actual, polygon_plan(machine, *actual, 0, {0}), options).readings;
  InstrumentObservations observations(machine, table_errors(0), nominal, readings);
  Problem problem = estimate_everything(machine, table_errors(0), {borrowed(observations)});
  problem.machine_parameters.resize(6 * kCoefficients);  // not the tool: there is none

  const Identification found = identify(problem);
  ASSERT_EQ(found.status, IdentifyStatus::converged) << found.message;
  // The 21 directions of docs/polygon.md without the two tilts of the mirror, which is taken as square here.
  EXPECT_EQ(found.gauge.parameter_count, 108U);
  EXPECT_EQ(found.gauge.rank_at_start, 89U);
  EXPECT_EQ(found.gauge.constraints.size(), 19U);
  EXPECT_GT(found.statistics.p_value, 1e-3);
  EXPECT_LT(found.statistics.p_value, 0.999);

  // What no gauge touches: harmonics two to four of all motions, the first of ECC and EZC.
  const auto coefficient = [&](const ErrorSet& errors, std::size_t motion, std::size_t k) {
    return errors.motions[motion].coefficients[k];
  };
  for (std::size_t motion = 0; motion < 6; ++motion) {
    const bool own = motion == 2 || motion == 5;
    for (std::size_t k = own ? 1 : 3; k < kCoefficients; ++k) {
      const double uncertainty = found.standard_uncertainties[static_cast<Eigen::Index>(motion * kCoefficients + k)];
      EXPECT_GT(uncertainty, 0);
      EXPECT_NEAR(coefficient(found.errors, motion, k), coefficient(truth, motion, k),
                  4.5 * uncertainty + (motion < 3 ? 5e-6 : 2e-3 * kArcsec))
          << motion << " " << k;
    }
  }
  // ... and the once-per-turn parts of radial and tilt motion that turn against the table.
  for (const std::size_t first : {0U, 3U}) {
    for (const bool quarter : {false, true}) {
      const auto against = [&](const ErrorSet& errors) {
        return quarter ? coefficient(errors, first + 1, 1) + coefficient(errors, first, 2)
                       : coefficient(errors, first, 1) - coefficient(errors, first + 1, 2);
      };
      EXPECT_NEAR(against(found.errors), against(truth), first == 0 ? 60e-6 : 0.1 * kArcsec) << first << quarter;
    }
  }
}

TEST(PolygonIdentification, OneMountCannotTellTheTableFromThePrism) {
  const Machine machine = test::rotary_table();
  PolygonGaugeSetup setup = prism(0);
  setup.mounts.pop_back();
  const auto nominal = std::make_shared<PolygonGauge>(setup);
  InstrumentSimulationOptions options;
  const InstrumentReadings readings =
      simulate_instrument(machine, table_errors(4), nominal, polygon_plan(machine, *nominal, 0, {0}), options).readings;
  InstrumentObservations observations(machine, table_errors(0), nominal, readings);
  Problem problem = estimate_everything(machine, table_errors(0), {borrowed(observations)});
  problem.machine_parameters.resize(6 * kCoefficients);
  const NullSpace unseen = find_null_space(problem, present_values(problem));
  EXPECT_LE(unseen.rank, 72U);
  EXPECT_EQ(unseen.column_norms.size(), 102);
}

}  // namespace
}  // namespace abbe
