#include "abbe/formats/machine/expansion_fields.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "abbe/errors/error_states.h"
#include "abbe/errors/random_stream.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/machine/state_option.h"
#include "abbe/formats/text/message_of.h"

namespace abbe {
namespace {

using testing::HasSubstr;

Machine saw_with_scales() {
  return parse_machine(R"(name = "saw"
chain = "w X' b Z C t"
[axis.X]
travel_mm = [0, 760]
[axis.Z]
travel_mm = [0, 400]
[axis.C]
endless = true
[state.scale_x]
kind = "measured"
unit = "degC"
[state.load]
kind = "measured"
unit = "kg"
)",
                       "saw.machine.toml");
}

ErrorsFile saw_errors(const std::string& text, StatesOfErrors states = StatesOfErrors::allowed) {
  return parse_errors(text, "saw.errors.toml", saw_with_scales(), states);
}

std::string expansion_refusal(const std::string& change, StatesOfErrors states = StatesOfErrors::allowed) {
  return message_of([&] { saw_errors("[[expansion]]\n" + change, states); });
}

const std::string kExpansion = R"([[expansion]]
axis = "X"
state = "scale_x"
coefficient_um_per_m_K = 8.3
coefficient_standard_uncertainty_um_per_m_K = 0.5
fixed_point_mm = 120
)";

TEST(ExpansionsInErrorsFiles, AreErrorMotionsWithAState) {
  // X' carries the workpiece, so what makes it move too far moves the body in -X.
  const ErrorsFile file = saw_errors(kExpansion);
  const ErrorsFile written_out = saw_errors(R"([[motion]]
name = "EXX"
state = "scale_x"
basis = "monomial"
order = 1
from_mm = -880
to_mm = 1120
coefficients_um = [0, -8.3]
standard_uncertainty_um = [0, 0.5]
)");
  ASSERT_EQ(file.errors.motions.size(), 1U);
  const ErrorMotion &found = file.errors.motions[0], &expected = written_out.errors.motions[0];
  EXPECT_EQ(found.basis, expected.basis);
  EXPECT_EQ(found.state, expected.state);
  EXPECT_NEAR(found.coefficients[1], expected.coefficients[1], 1e-12 * 8.3e-3);
  EXPECT_NEAR(found.standard_uncertainty[1], expected.standard_uncertainty[1], 1e-12 * 0.5e-3);
  EXPECT_EQ(covariance_of(file).rows(), 5);
  const Machine saw = saw_with_scales();
  EXPECT_EQ(parameter_names(saw, file.errors)[1], "EXX*scale_x[s^1]");
}

TEST(ExpansionsInErrorsFiles, ReadBackTheSameBitsAndSayWhatTheyAre) {
  const Machine saw = saw_with_scales();
  ErrorsFile file = saw_errors(kExpansion + "temperature_standard_uncertainty_K = 0.2\n");
  ASSERT_EQ(file.errors.motions.size(), 2U);
  const std::string text = errors_text(saw, file);
  EXPECT_THAT(text, HasSubstr("name = \"EXX\"  # scale of X: 8.3 um/(m K), fixed at 120 mm"));
  EXPECT_EQ(saw_errors(text).errors.motions, file.errors.motions);
  // Ageing is that of the error motion and not of the thermometer.
  file.ageing.length = 1e-3;
  add_ageing(saw, 1, file);
  EXPECT_EQ(file.covariance(2, 2), 0);
}

TEST(ExpansionsInErrorsFiles, AreTakenAtAStateWithTheirUncertainty) {
  const Machine saw = saw_with_scales();
  const ErrorsFile file = saw_errors(kExpansion + "temperature_standard_uncertainty_K = 0.2\n");
  const ErrorsFile warm = at_given_states(saw, file, std::vector<double>{26, std::nan("")}, "saw.errors.toml");
  EXPECT_FALSE(has_states(warm.errors));
  const double actual = warm.errors.evaluate(0, 620)[0];
  EXPECT_NEAR(actual, -8.3e-6 * 6 * 500, 1e-15);
  // At s = 0.5: u = sqrt(6^2 0.5^2 + (8.3^2 + 0.5^2) 0.2^2) / 2 um.
  double variance = 0;
  for (const ErrorMotion& motion : warm.errors.motions) variance += std::pow(0.5 * motion.standard_uncertainty[1], 2);
  EXPECT_NEAR(1e3 * std::sqrt(variance), 0.5 * std::sqrt(9 + 69.14 * 0.04), 1e-9);
}

const std::string kSharedThermometer = R"([[expansion]]
axis = "X"
state = "scale_x"
coefficient_um_per_m_K = 8
coefficient_standard_uncertainty_um_per_m_K = 0.5
temperature_standard_uncertainty_K = 0.1
thermometer = "A"
thermometer_standard_uncertainty_K = 0.2
[[expansion]]
axis = "Z"
state = "scale_x"
coefficient_um_per_m_K = 11
temperature_standard_uncertainty_K = 0.15
thermometer = "A"
thermometer_standard_uncertainty_K = 0.3
[[location]]
name = "EB0Z"
value_urad = 5
standard_uncertainty_urad = 2
)";

TEST(ExpansionsInErrorsFiles, OfOneThermometerShareItsError) {
  const ErrorsFile file = saw_errors(kSharedThermometer);
  const Machine saw = saw_with_scales();
  const std::vector<std::string> names = parameter_names(saw, file.errors);
  const auto index = [&](const std::string& name) {
    return std::find(names.begin(), names.end(), name) - names.begin();
  };
  const Eigen::Index x = index("EXX[s^1]"), z = index("EZZ[s^1]"), location = index("EB0Z");
  ASSERT_EQ(file.covariance.rows(), static_cast<Eigen::Index>(names.size()));
  // Independent: what thermometers and coefficients that are wrong do over one metre, um; X' moves in -X.
  RandomStream random(6);
  constexpr int kDraws = 200000;
  double xx = 0, zz = 0, xz = 0;
  for (int draw = 0; draw < kDraws; ++draw) {
    const double shared = random.normal();
    const double of_x = -(8 + 0.5 * random.normal()) * (0.1 * random.normal() + 0.2 * shared);
    const double of_z = 11 * (0.15 * random.normal() + 0.3 * shared);
    xx += of_x * of_x / kDraws;
    zz += of_z * of_z / kDraws;
    xz += of_x * of_z / kDraws;
  }
  EXPECT_NEAR(1e6 * file.covariance(x, x) / xx, 1, 0.02);
  EXPECT_NEAR(1e6 * file.covariance(z, z) / zz, 1, 0.02);
  EXPECT_NEAR(1e6 * file.covariance(x, z) / xz, 1, 0.02);
  EXPECT_NEAR(1e6 * file.covariance(x, z), -8 * 0.2 * 11 * 0.3, 1e-12);
  EXPECT_EQ(file.covariance(z, x), file.covariance(x, z));
  EXPECT_NEAR(file.covariance(location, location), 4e-12, 1e-24);
  EXPECT_EQ((file.covariance.array() != 0).count(), 6) << "four terms and two that they share";
}

TEST(ExpansionsInErrorsFiles, TheirCovarianceGoesIntoThatAtAState) {
  const Machine saw = saw_with_scales();
  const ErrorsFile warm =
      at_given_states(saw, saw_errors(kSharedThermometer), std::vector<double>{26, std::nan("")}, "saw.errors.toml");
  // Both axes at 1 m: the point moves by the sum of both along (1, 1) in X and Z, each variance as at 26 degC.
  double sum = 0;
  for (Eigen::Index i = 0; i < warm.covariance.rows(); ++i) {
    for (Eigen::Index j = 0; j < warm.covariance.cols(); ++j) {
      if (i != warm.covariance.rows() - 4 && j != warm.covariance.rows() - 4) sum += warm.covariance(i, j);
    }
  }
  const double of_x = 0.25 * 36 + 64.25 * (0.01 + 0.04), of_z = 121 * (0.0225 + 0.09);
  EXPECT_NEAR(1e6 * sum, of_x + of_z - 2 * 8 * 0.2 * 11 * 0.3, 1e-9);
}

TEST(ExpansionsInErrorsFiles, WithOneScaleOfAThermometerNothingIsShared) {
  std::string other = kSharedThermometer;
  other.replace(other.rfind("\"A\""), 3, "\"B\"");
  EXPECT_EQ(saw_errors(other).covariance.size(), 0);
  EXPECT_THAT(expansion_refusal("axis = \"X\"\nstate = \"scale_x\"\ncoefficient_um_per_m_K = 8\nthermometer = \"A\"\n"),
              HasSubstr("thermometer_standard_uncertainty_K: is missing or zero beside the thermometer"));
  EXPECT_THAT(expansion_refusal("axis = \"X\"\nstate = \"scale_x\"\ncoefficient_um_per_m_K = "
                                "8\nthermometer_standard_uncertainty_K = 0.1\n"),
              HasSubstr("expansion[1].thermometer: is missing beside its uncertainty"));
}

TEST(ExpansionsInErrorsFiles, WhatIsWrongIsNamed) {
  const std::string good = "axis = \"X\"\nstate = \"scale_x\"\n";
  EXPECT_THAT(expansion_refusal(good), HasSubstr("expansion[1].coefficient_um_per_m_K: missing"));
  EXPECT_THAT(expansion_refusal(good + "coefficient_um = 8\n"), HasSubstr("coefficient_um_per_m_K"));
  EXPECT_THAT(
      expansion_refusal(good + "coefficient_um_per_m_K = 8\ncoefficient_standard_uncertainty_um_per_m_K = -1\n"),
      HasSubstr("coefficient_standard_uncertainty_um_per_m_K: is negative"));
  EXPECT_THAT(expansion_refusal(good + "coefficient_um_per_m_K = 8\ntemperature_standard_uncertainty_K = -1\n"),
              HasSubstr("temperature_standard_uncertainty_K: is negative"));
  EXPECT_THAT(expansion_refusal(good + "coefficient_um_per_m_K = 8000\n"), HasSubstr("is too large"));
  EXPECT_THAT(expansion_refusal("axis = \"X\"\ncoefficient_um_per_m_K = 8\n"), HasSubstr("expansion[1].state"));
  EXPECT_THAT(expansion_refusal("axis = \"X\"\nstate = \"scale_y\"\ncoefficient_um_per_m_K = 8\n"),
              HasSubstr("\"scale_y\" is not a state of this machine"));
  EXPECT_THAT(expansion_refusal("axis = \"X\"\nstate = \"load\"\ncoefficient_um_per_m_K = 8\n"),
              HasSubstr("load is not a temperature; expected a measured state with the unit degC"));
  EXPECT_THAT(expansion_refusal("axis = \"C\"\nstate = \"scale_x\"\ncoefficient_um_per_m_K = 8\n"),
              HasSubstr("the scale of a rotary axis does not expand"));
  EXPECT_THAT(expansion_refusal("axis = \"Y\"\nstate = \"scale_x\"\ncoefficient_um_per_m_K = 8\n"),
              HasSubstr("\"Y\" is not an axis of this machine"));
  EXPECT_THAT(message_of([&] { saw_errors(kExpansion + kExpansion); }), HasSubstr("expansion with this state already"));
  EXPECT_THAT(expansion_refusal(good + "coefficient_um_per_m_K = 8\n", StatesOfErrors::refused),
              HasSubstr("this error depends on scale_x, which is not taken into account here"));
}

}  // namespace
}  // namespace abbe
