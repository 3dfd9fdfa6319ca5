#include "abbe/verify/evaluations/differential_expansion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "abbe/errors/random_stream.h"

namespace abbe {
namespace {

constexpr int kRuns = 5;

/// What an axis has at 20 degC, mm.
using AxisDeviation = std::function<double(double position, bool positive, RandomStream& noise)>;

struct WarmTest {
  std::vector<PositioningReading> readings;  ///< as read, warm
  std::vector<BodyTemperatures> at;
};

/// Positions of the machine and of the instrument from their own bodies, without the formula under test: a scale whose
/// graduation stands too far away, and a measure whose graduations are too far apart.
WarmTest read_warm(const AxisDeviation& axis, const DifferentialExpansion& real, std::uint64_t seed, double drift) {
  WarmTest test;
  RandomStream noise(seed);
  int reading = 0;
  for (int run = 0; run < kRuns; ++run) {
    for (const bool positive : {true, false}) {
      for (int i = 0; i < 11; ++i) {
        const int at_target = positive ? i : 10 - i;
        const double target = 90.0 * at_target + 3 * std::sin(at_target);
        const double warm = drift * reading++;
        const BodyTemperatures at{24.5 + warm, 22.25 + 0.5 * warm};
        const double at_20 = target + axis(target, positive, noise);
        const double stands = real.machine.fixed_point +
                              (1 + real.machine.coefficient * (at.machine - 20)) * (at_20 - real.machine.fixed_point);
        const double grown = 1 + real.instrument.coefficient * (at.instrument - 20);
        const double indicated = real.instrument.fixed_point + (stands - real.instrument.fixed_point) / grown;
        test.readings.push_back(
            {target, indicated - target, positive ? ApproachDirection::positive : ApproachDirection::negative});
        test.at.push_back(at);
      }
    }
  }
  return test;
}

double bowed(double position, bool positive, RandomStream& noise) {
  return 8e-3 * std::sin(position / 250) + (positive ? 1e-3 : -1e-3) + 0.4e-3 * noise.normal();
}

DifferentialExpansion glass_and_steel() {
  return {.machine = {8e-6, 0.5e-6, 0.3, 50},
          .instrument = {11.5e-6, 0.8e-6, 0.2, -20},
          .common_temperature_uncertainty = 0.15};
}

TEST(DifferentialExpansion, CorrectedDeviationsAreThoseOfTheAxisAt20Degrees) {
  for (const double drift : {0.0, 0.01}) {
    const DifferentialExpansion expansion = glass_and_steel();
    const WarmTest warm = read_warm(bowed, expansion, 3, drift);
    DifferentialExpansion none;
    const WarmTest cold = read_warm(bowed, none, 3, drift);
    const std::vector<PositioningReading> corrected =
        corrected_to_reference_temperature(warm.readings, expansion, warm.at);
    double largest = 0;
    for (std::size_t i = 0; i < corrected.size(); ++i) {
      // Second order: the strain of the strain, and of the deviation, below a nanometre.
      EXPECT_NEAR(corrected[i].deviation, cold.readings[i].deviation, 1e-6) << i;
      largest = std::max(largest, std::abs(warm.readings[i].deviation - cold.readings[i].deviation));
    }
    EXPECT_GT(largest, 5e-3);
  }
}

TEST(DifferentialExpansion, IsWorkedByHand) {
  // 8 um/(m K), 4 K, 1 m less 11.5 um/(m K), 2 K, 1 m: 32 - 23 um.
  const DifferentialExpansion expansion{.machine = {8e-6, 0, 0, 0}, .instrument = {11.5e-6, 0, 0, 0}};
  EXPECT_NEAR(nominal_differential_expansion(expansion, 1000, {24, 22}), 0.009, 1e-12);
  EXPECT_EQ(nominal_differential_expansion(expansion, 1000, {}), 0);
  EXPECT_FALSE(expansion.has_uncertainty());
  const std::vector<PositioningReading> readings = {{1000, 0, ApproachDirection::positive}};
  EXPECT_TRUE(expansion_contributions(readings, expansion, {{24, 22}}).empty());
  const auto found = expansion_contributions(
      readings,
      {.machine = {8e-6, 0.5e-6, 0.3, 0}, .instrument = {11.5e-6, 0, 0, 0}, .common_temperature_uncertainty = 0.2},
      {{24, 22}});
  ASSERT_EQ(found.size(), 3U);
  EXPECT_NEAR(found[0].standard[0], 0.5e-6 * 4 * 1000, 1e-15);
  // u^2 = (8^2 + 0.5^2) 0.3^2 + 0.5^2 0.2^2 um^2
  EXPECT_NEAR(found[1].standard[0], 1e-3 * std::sqrt(64.25 * 0.09 + 0.25 * 0.04), 1e-12);
  // Both thermometers too high by 0.2 K: (8 - 11.5) 0.2 um.
  EXPECT_NEAR(found[2].standard[0], -3.5e-3 * 0.2, 1e-12);
}

/// Figures of many tests whose coefficients and thermometers are wrong as stated.
struct ManyTests {
  std::array<double, kPositioningFigures> deviation{};  ///< standard, of each figure
  std::array<double, kPositioningFigures> covered{};    ///< share within the expanded uncertainty of the truth
};

ManyTests many_tests(const AxisDeviation& axis, const DifferentialExpansion& stated, double drift,
                     const std::array<double, kPositioningFigures>& expanded) {
  constexpr int kDraws = 4000;
  DifferentialExpansion none;
  const WarmTest cold = read_warm(axis, none, 5, drift);
  const auto truth = positioning_figures(evaluate_positioning(cold.readings));
  std::array<double, kPositioningFigures> sum{}, squares{};
  ManyTests result;
  for (int draw = 0; draw < kDraws; ++draw) {
    RandomStream random(77, static_cast<std::uint64_t>(draw));
    DifferentialExpansion real = stated;
    real.machine.coefficient += stated.machine.coefficient_uncertainty * random.normal();
    real.instrument.coefficient += stated.instrument.coefficient_uncertainty * random.normal();
    WarmTest warm = read_warm(axis, real, 5, drift);
    const double common = stated.common_temperature_uncertainty * random.normal();
    const double of_machine = common + stated.machine.temperature_uncertainty * random.normal();
    const double of_instrument = common + stated.instrument.temperature_uncertainty * random.normal();
    for (BodyTemperatures& one : warm.at) {
      one.machine += of_machine;
      one.instrument += of_instrument;
    }
    const auto found =
        positioning_figures(evaluate_positioning(corrected_to_reference_temperature(warm.readings, stated, warm.at)));
    for (std::size_t f = 0; f < found.size(); ++f) {
      sum[f] += found[f].value / kDraws;
      squares[f] += found[f].value * found[f].value / kDraws;
      if (std::abs(found[f].value - truth[f].value) <= expanded[f]) result.covered[f] += 1.0 / kDraws;
    }
  }
  for (std::size_t f = 0; f < sum.size(); ++f) {
    result.deviation[f] = std::sqrt(std::max(0.0, squares[f] - sum[f] * sum[f]));
  }
  return result;
}

std::array<double, kPositioningFigures> stated_uncertainty(const AxisDeviation& axis,
                                                           const DifferentialExpansion& expansion, double drift) {
  const WarmTest warm = read_warm(axis, expansion, 5, drift);
  return expanded_by_expansion(corrected_to_reference_temperature(warm.readings, expansion, warm.at),
                               expansion_contributions(warm.readings, expansion, warm.at));
}

TEST(DifferentialExpansion, UncertaintiesAreThoseOfManyTests) {
  const AxisDeviation steep = [](double position, bool positive, RandomStream& noise) {
    return 60e-6 * position + bowed(position, positive, noise) * 0.2;
  };
  for (const double drift : {0.0, 0.02}) {
    const auto expanded = stated_uncertainty(steep, glass_and_steel(), drift);
    const ManyTests many = many_tests(steep, glass_and_steel(), drift, expanded);
    // The extremes stand at both ends: A, A+, A-, E, E+, E-, M follow the expansion in proportion.
    for (std::size_t f = 0; f < 7; ++f) {
      EXPECT_GT(expanded[f], 4e-3) << f;
      if (f < 3 && drift > 0) {
        // The scatter of runs at other temperatures grows in either sense of an error: A is not proportional to it.
        EXPECT_GT(expanded[f], 2 * many.deviation[f]) << f;
        EXPECT_GT(many.covered[f], 0.954) << f;
        continue;
      }
      EXPECT_NEAR(2 * many.deviation[f], expanded[f], 0.05 * expanded[f]) << f << " drift " << drift;
      EXPECT_NEAR(many.covered[f], 0.954, 0.015) << f;
    }
    if (drift > 0) continue;
    for (std::size_t f = 7; f < kPositioningFigures; ++f) {
      EXPECT_LT(expanded[f], 1e-12) << "a constant temperature changes neither reversal nor repeatability: " << f;
    }
  }
}

TEST(DifferentialExpansion, TemperaturesThatChangeAreInReversalAndRepeatability) {
  // The correction itself is uncertain in proportion to the temperature: runs of a warming axis differ.
  const auto expanded = stated_uncertainty(bowed, glass_and_steel(), 0.03);
  const ManyTests many = many_tests(bowed, glass_and_steel(), 0.03, expanded);
  for (std::size_t f = 0; f < kPositioningFigures; ++f) {
    EXPECT_GT(expanded[f], 1e-5) << f;
    EXPECT_GT(many.covered[f], 0.92) << f;
    EXPECT_LT(2 * many.deviation[f], 1.2 * expanded[f]) << f;
  }
}

TEST(DifferentialExpansion, OfAPerfectAxisIsNotUnderstated) {
  const AxisDeviation perfect = [](double, bool, RandomStream&) { return 0.0; };
  const auto expanded = stated_uncertainty(perfect, glass_and_steel(), 0);
  const ManyTests many = many_tests(perfect, glass_and_steel(), 0, expanded);
  for (std::size_t f = 0; f < 7; ++f) EXPECT_GE(many.covered[f], 0.945) << f;
}

TEST(DifferentialExpansion, FiguresThatAreNotEvaluatedHaveNone) {
  const std::vector<PositioningReading> one_side = {{0, 0, ApproachDirection::positive},
                                                    {100, 0, ApproachDirection::positive}};
  const DifferentialExpansion expansion = glass_and_steel();
  const std::vector<BodyTemperatures> at(2, {24, 23});
  const auto expanded = expanded_by_expansion(one_side, expansion_contributions(one_side, expansion, at));
  EXPECT_EQ(expanded[0], 0) << "A";
  EXPECT_GT(expanded[4], 0) << "E+";
  EXPECT_EQ(expanded[10], 0) << "B";
}

}  // namespace
}  // namespace abbe
