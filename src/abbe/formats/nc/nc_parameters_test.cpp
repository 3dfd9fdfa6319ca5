#include "abbe/formats/nc/nc_parameters.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace abbe {
namespace {

/// NaN where the parameter has no value.
template <typename Name>
double value_of(const NcParameters& parameters, Name name) {
  double value = 0;
  return parameters.get(name, value) ? value : std::numeric_limits<double>::quiet_NaN();
}

TEST(NcParameters, ASubroutineHasItsArgumentsAndItsCallerKeepsItsOwn) {
  NcParameters parameters;
  parameters.set(1, 5);
  parameters.set(31, 6);
  parameters.set("here", 7);
  parameters.set("_everywhere", 8);
  parameters.enter({2, 3});
  EXPECT_EQ(value_of(parameters, 1), 2);
  EXPECT_EQ(value_of(parameters, 2), 3);
  EXPECT_EQ(value_of(parameters, 30), 0);
  EXPECT_EQ(value_of(parameters, 31), 6);
  EXPECT_TRUE(std::isnan(value_of(parameters, "here")));
  EXPECT_EQ(value_of(parameters, "_everywhere"), 8);
  parameters.set(1, 9);
  parameters.set("_everywhere", 10);
  parameters.leave();
  EXPECT_EQ(value_of(parameters, 1), 5);
  EXPECT_TRUE(std::isnan(value_of(parameters, 2)));
  EXPECT_EQ(value_of(parameters, "here"), 7);
  EXPECT_EQ(value_of(parameters, "_everywhere"), 10);
}

TEST(NcParameters, ASubprogramHasTheNumbersOfItsCallerAndNamesOfItsOwn) {
  NcParameters parameters;
  parameters.set(1, 5);
  parameters.set("here", 7);
  parameters.enter_subprogram();
  EXPECT_EQ(value_of(parameters, 1), 5);
  EXPECT_TRUE(std::isnan(value_of(parameters, "here")));
  parameters.set(1, 6);
  parameters.set(2, 3);
  parameters.set("here", 8);
  parameters.leave_subprogram();
  EXPECT_EQ(value_of(parameters, 1), 6);
  EXPECT_EQ(value_of(parameters, 2), 3);
  EXPECT_EQ(value_of(parameters, "here"), 7);
  EXPECT_EQ(parameters.depth(), 0U);
}

TEST(NcParameters, TheStateOfTheControlComesBeforeWhatWasStored) {
  class State final : public NcSystemValues {
   public:
    bool numbered(int number, double& value) const override {
      value = 1.5;
      return number == 5420;
    }
    bool named(std::string_view name, double& value) const override {
      value = 2.5;
      return name == "_x";
    }
  };
  NcParameters parameters;
  parameters.set(5420, 3);
  parameters.set(5421, 4);
  parameters.set("_x", 5);
  EXPECT_EQ(value_of(parameters, 5420), 3);
  const State state;
  parameters.set_system(state);
  EXPECT_EQ(value_of(parameters, 5420), 1.5);
  EXPECT_EQ(value_of(parameters, 5421), 4);
  EXPECT_EQ(value_of(parameters, "_x"), 2.5);
  EXPECT_TRUE(std::isnan(value_of(parameters, "_y")));
}

}  // namespace
}  // namespace abbe
