#include "abbe/study/report/found_values_words.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace abbe {
namespace {

using testing::HasSubstr;
using testing::Not;

std::string printed(const FoundValues& found) { return found_values_text(found, "--every-value"); }

TEST(FoundValuesWords, WhatWasNotEstimatedHasNoUncertainty) {
  FoundPlace place{.name = "pose", .position = {1, 2, 3}, .position_expanded = {1e-3, 2e-3, 3e-3}};
  place.rotation = Eigen::Matrix3d::Identity();
  FoundPlace direction = place;
  direction.rotation.reset();
  direction.direction = Eigen::Vector3d::UnitX();
  for (FoundPlace one : {place, direction}) {
    FoundValues found;
    found.setups.push_back({"one", "instrument", {one}, {}});
    EXPECT_THAT(printed(found), HasSubstr("U (1, 2, 3) um"));
    EXPECT_THAT(printed(found), HasSubstr(", not estimated: as stated or by convention\n"));
    EXPECT_FALSE(found_values_json(found)["setups"][0]["places"][0].contains("turn_expanded_uncertainty_urad"));
    one.turn_expanded = {0, 2e-6, 3e-6};
    found.setups[0].places = {one};
    EXPECT_THAT(printed(found), HasSubstr("U of a turn about x, y, z (0, 2, 3) urad"));
    EXPECT_THAT(printed(found), Not(HasSubstr("not estimated")));
    EXPECT_EQ(found_values_json(found)["setups"][0]["places"][0]["turn_expanded_uncertainty_urad"].size(), 3u);
  }
}

TEST(FoundValuesWords, AScaleIsWrittenInMicrometresPerMetreAndKeepsItsFieldsInJson) {
  FoundValues found;
  FoundNumber scale{.name = "grid.scale_x", .words = {}, .value = -4.5e-6, .expanded_uncertainty = 2e-7};
  scale.is_pure_number = true;
  found.setups.push_back({"grid", "grid-encoder", {}, {scale}});
  EXPECT_THAT(printed(found), testing::ContainsRegex("grid.scale_x +-4.500 um/m +0.2 um/m"));
  scale.is_angle = true;
  found.setups[0].numbers = {scale};
  EXPECT_THAT(printed(found), testing::ContainsRegex("grid.scale_x +-4.500 um/m +0.2 um/m"));
  found.setups[0].numbers[0].is_angle = false;
  EXPECT_TRUE(found_values_json(found)["setups"][0]["values"][0].contains("value_mm"));
}

TEST(FoundValuesWords, WhereNumbersAreCutTheOptionOfTheCommandIsNamed) {
  FoundValues found;
  found.setups.push_back(
      {"one", "instrument", {}, std::vector<FoundNumber>(14, FoundNumber{.name = "length", .words = {}})});
  EXPECT_THAT(printed(found), HasSubstr("\n    2 more: --every-value\n"));
}

}  // namespace
}  // namespace abbe
