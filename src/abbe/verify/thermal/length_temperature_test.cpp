#include "abbe/verify/thermal/length_temperature.h"

#include <gtest/gtest.h>

#include <cmath>

namespace abbe {
namespace {

constexpr double kNanometre = 1e-6;  // mm

/// The end gauge of JCGM 100:2008, H.1, of nominally 50 mm: there the difference of two coefficients is 0 with a
/// rectangular distribution of half width 1e-6 / K, the mean temperature 19.9 degC with the variance 0.165 K^2, the
/// difference of two temperatures 0 with half width 0.05 K, the coefficient 11.5e-6 / K.
TEST(LengthTemperature, ContributionsAreThoseOfTheEndGaugeOfTheGum) {
  LengthTemperatureInput coefficient;
  coefficient.length = 50;
  coefficient.workpiece_expansion_uncertainty = 1e-6 / std::sqrt(3);
  coefficient.workpiece_temperature = 19.9;
  EXPECT_NEAR(length_uncertainty(coefficient).combined / kNanometre, 2.9, 0.05) << "table H.1";
  coefficient.workpiece_temperature_uncertainty = std::sqrt(0.165);
  EXPECT_NEAR(length_uncertainty(coefficient).combined / kNanometre, std::hypot(2.9, 11.7), 0.05) << "with H.1.7";
  LengthTemperatureInput temperature;
  temperature.length = 50;
  temperature.workpiece_expansion = 11.5e-6;
  temperature.workpiece_temperature_uncertainty = 0.05 / std::sqrt(3);
  EXPECT_NEAR(length_uncertainty(temperature).combined / kNanometre, 16.6, 0.05) << "table H.1";
}

TEST(LengthTemperature, ByHand) {
  LengthTemperatureInput input;
  input.length = 1000;
  input.workpiece_expansion = 23e-6;
  input.workpiece_expansion_uncertainty = 1e-6;
  input.workpiece_temperature = 24;
  input.scale_expansion = 8e-6;
  input.scale_expansion_uncertainty = 0.5e-6;
  input.scale_temperature = 22;
  input.environmental_variation = 6e-3;
  const LengthUncertainty found = length_uncertainty(input);
  EXPECT_NEAR(found.differential_expansion, 1000 * (23e-6 * 4 - 8e-6 * 2), 1e-12);
  EXPECT_NEAR(found.differential_uncertainty, 1e-3 * std::hypot(4, 1), 1e-12);
  ASSERT_EQ(found.contributions.size(), 3U);
  EXPECT_STREQ(found.contributions[2].name, "environment (ETVE)");
  EXPECT_NEAR(found.contributions[2].standard, 6e-3 / std::sqrt(12), 1e-12);
  EXPECT_NEAR(found.combined, std::sqrt(16e-6 + 1e-6 + 3e-6), 1e-9);
}

TEST(LengthTemperature, AtTheReferenceTemperatureTheTemperatureRemains) {
  LengthTemperatureInput input;
  input.length = 500;
  input.workpiece_expansion = 12e-6;
  input.workpiece_expansion_uncertainty = 1e-6;
  EXPECT_EQ(length_uncertainty(input).combined, 0);
  EXPECT_TRUE(length_uncertainty(input).contributions.empty());
  input.workpiece_temperature_uncertainty = 0.5;
  EXPECT_EQ(length_uncertainty(input).differential_expansion, 0);
  EXPECT_NEAR(length_uncertainty(input).combined, 500 * 0.5 * std::hypot(12e-6, 1e-6), 1e-12);
}

}  // namespace
}  // namespace abbe
