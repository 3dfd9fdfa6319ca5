#include "abbe/formats/machine/state_option.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "abbe/errors/actual_pose.h"
#include "abbe/errors/error_states.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/text/message_of.h"

namespace abbe {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Pair;

Machine warm_mill() {
  return parse_machine(R"(name = "mill"
chain = "w b X Z t"
[axis.X]
travel_mm = [0, 800]
[axis.Z]
travel_mm = [0, 400]
[tool]
reference_mm = [0, 0, 250]
[state.ambient]
kind = "measured"
unit = "degC"
[state.column]
kind = "lag"
of = "ambient"
time_constant_s = 1800
[state.load]
kind = "measured"
unit = "1"
[state.reach]
kind = "axis"
axis = "Z"
[state.sag]
kind = "product"
of = ["load", "reach"]
)",
                       "mill.machine.toml");
}

const char* const kWarmErrors = R"([[motion]]
name = "EXX"
basis = "legendre"
order = 1
coefficients_um = [0, 4]
standard_uncertainty_um = [0.1, 0.2]
[[motion]]
name = "EXX"
state = "ambient"
basis = "legendre"
order = 1
coefficients_um = [0.5, 4.6]
standard_uncertainty_um = [0.03, 0.05]
[[location]]
name = "EB0Z"
value_urad = 20
standard_uncertainty_urad = 2
[[location]]
name = "EB0Z"
state = "column"
value_urad = -3
standard_uncertainty_urad = 0.5
)";

ErrorsFile warm_errors(const Machine& machine) {
  return parse_errors(kWarmErrors, "mill.errors.toml", machine, StatesOfErrors::allowed);
}

std::string message_of_option(const std::vector<std::string>& texts) {
  return message_of([&] { state_options(warm_mill(), "--state", texts); });
}

TEST(StateOption, TakesValuesByTheNamesOfColumns) {
  const std::vector<double> values = state_options(warm_mill(), "--state", {"column_degC=-1.5", "load=2e3"});
  ASSERT_EQ(values.size(), 5U);
  EXPECT_TRUE(std::isnan(values[0]));
  EXPECT_EQ(values[1], -1.5);
  EXPECT_EQ(values[2], 2000);
  EXPECT_TRUE(std::isnan(values[3]));
  EXPECT_TRUE(std::isnan(state_options(warm_mill(), "--state", {})[0]));
}

TEST(StateOption, SaysWhatIsWrong) {
  EXPECT_EQ(message_of_option({"ambiant_degC=26"}),
            "--state ambiant_degC=26: the machine has no state 'ambiant_degC' (did you mean ambient_degC?); expected "
            "ambient_degC, column_degC, load");
  EXPECT_EQ(message_of_option({"ambient=26"}),
            "--state ambient=26: the unit is missing from the name; expected ambient_degC, column_degC, load");
  EXPECT_EQ(message_of_option({"reach=26"}),
            "--state reach=26: 'reach' is computed at every pose (axis); expected ambient_degC, column_degC, load");
  EXPECT_EQ(message_of_option({"ambient_K=26"}).find("--state ambient_K=26: the machine has no state 'ambient_K'"), 0U);
  EXPECT_EQ(message_of_option({"load"}),
            "--state load: not understood; expected NAME_unit=value, such as ambient_degC=26.5");
  EXPECT_THAT(message_of_option({"load="}), HasSubstr("not a number"));
  EXPECT_THAT(message_of_option({"load=1,5"}), HasSubstr("not a number"));
  EXPECT_THAT(message_of_option({"load=nan"}), HasSubstr("--state load=nan: not "));
  EXPECT_THAT(message_of_option({"load=inf"}), HasSubstr("--state load=inf: not "));
  EXPECT_THAT(message_of_option({"load=1e10"}), HasSubstr("too large; expected at most 1e+09"));
  EXPECT_THAT(message_of_option({"load=1e999"}), HasSubstr("--state load=1e999: "));
  EXPECT_EQ(message_of_option({"load=1", "load=1"}), "--state load=1: was given before; expected each state once");
}

TEST(StateOption, ErrorsAtAStateMoveTheToolAsTheErrorsDoThere) {
  const Machine machine = warm_mill();
  const std::vector<double> values = state_options(machine, "--state", {"ambient_degC=26.5", "column_degC=24"});
  const ErrorsFile file = at_given_states(machine, warm_errors(machine), values, "mill.errors.toml");
  EXPECT_FALSE(has_states(file.errors));
  EXPECT_THAT(file.at_state, ElementsAre(Pair("ambient_degC", 26.5), Pair("column_degC", 24)));
  EXPECT_EQ(state_words(file.at_state), "ambient_degC = 26.5, column_degC = 24");
  EXPECT_EQ(file.provenance.back().second, "ambient_degC = 26.5, column_degC = 24");
  // By hand, at X = 800 mm, Z = 100 mm: both Legendre functions are 1 there, and Z has gone 100 mm along its line.
  const Eigen::Vector3d shift = actual_workpiece_from_tool(machine, file.errors, {800, 100}).translation -
                                actual_workpiece_from_tool(machine, {}, {800, 100}).translation;
  const double along = 4 + 6.5 * (0.5 + 4.6), lean = 20 - 4 * 3;
  EXPECT_NEAR(1e3 * shift.x(), along + 1e-3 * lean * 100, 1e-4);
  // What it says of itself can be read again.
  EXPECT_THAT(errors_text(machine, file), HasSubstr("\"state\" = \"ambient_degC = 26.5, column_degC = 24\""));
  EXPECT_EQ(parse_errors(errors_text(machine, file), "again.errors.toml", machine).errors.motions, file.errors.motions);
}

TEST(StateOption, UncertaintiesFollowWithAndWithoutACovariance) {
  const Machine machine = warm_mill();
  const std::vector<double> values = state_options(machine, "--state", {"ambient_degC=26.5", "column_degC=24"});
  ErrorsFile file = warm_errors(machine);
  const ErrorsFile independent = at_given_states(machine, file, values, "");
  EXPECT_NEAR(independent.errors.motions[1].standard_uncertainty[1], 6.5 * 0.05e-3, 1e-15);
  ASSERT_EQ(independent.errors.locations.size(), 1U) << "both terms of EB0Z became one";
  EXPECT_NEAR(independent.errors.locations[0].value, 8e-6, 1e-15);
  EXPECT_NEAR(independent.errors.locations[0].standard_uncertainty, std::hypot(2.0, 4 * 0.5) * 1e-6, 1e-15);

  // Parameters: EXX 0 and 1, EXX*ambient 0 and 1, EB0Z, EB0Z*column, tool offset; correlation -0.5 of the last pair.
  file.covariance = Eigen::MatrixXd::Zero(9, 9);
  file.covariance.diagonal() << 1e-8, 4e-8, 9e-10, 25e-10, 4e-12, 0.25e-12, 0, 0, 0;
  file.covariance(4, 5) = file.covariance(5, 4) = -0.5 * 2e-6 * 0.5e-6;
  const ErrorsFile correlated = at_given_states(machine, file, values, "");
  ASSERT_EQ(correlated.covariance.rows(), 8);
  EXPECT_NEAR(correlated.covariance(3, 3), 6.5 * 6.5 * 25e-10, 1e-20);
  EXPECT_NEAR(correlated.covariance(4, 4), 4e-12 + 16 * 0.25e-12 + 2 * 4 * file.covariance(4, 5), 1e-24);
}

TEST(StateOption, StatesThatAreMissingAreNamedWithTheirOptions) {
  const Machine machine = warm_mill();
  const auto message = [&](const std::vector<std::string>& texts) {
    return message_of([&] {
      at_given_states(machine, warm_errors(machine), state_options(machine, "--state", texts), "mill.errors.toml");
    });
  };
  EXPECT_EQ(message({}),
            "mill.errors.toml: the errors depend on ambient, column, and no value is given; expected --state "
            "ambient_degC=VALUE --state column_degC=VALUE for the errors at a state");
  EXPECT_EQ(message({"ambient_degC=20"}),
            "mill.errors.toml: the errors depend on column, and no value is given; expected --state column_degC=VALUE "
            "for the errors at a state");
  // Errors that use no state are what they are at every state.
  ErrorsFile plain = parse_errors("[[location]]\nname = \"EB0Z\"\nvalue_urad = 20\n", "p.errors.toml", machine);
  const ErrorsFile same = at_given_states(machine, plain, state_options(machine, "--state", {"load=3"}), "");
  EXPECT_THAT(same.at_state, IsEmpty());
  EXPECT_EQ(same.errors.locations, plain.errors.locations);
}

TEST(StateOption, WhatIsComputedAtAPoseStaysAState) {
  const Machine machine = warm_mill();
  const ErrorsFile file = parse_errors(
      "[[motion]]\nname = \"EZX\"\nstate = \"sag\"\nbasis = \"legendre\"\norder = 0\ncoefficients_um = [0.01]\n",
      "sag.errors.toml", machine, StatesOfErrors::allowed);
  const ErrorsFile loaded = at_given_states(machine, file, state_options(machine, "--state", {"load=3"}), "");
  EXPECT_EQ(first_error_with_state(machine, loaded.errors), "EZX*reach");
  EXPECT_DOUBLE_EQ(loaded.errors.motions[0].coefficients[0], 0.03e-3);
  EXPECT_THAT(loaded.at_state, ElementsAre(Pair("load", 3)));
}

}  // namespace
}  // namespace abbe
