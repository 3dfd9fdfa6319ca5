#include "abbe/study/compensation/frozen_errors.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/text/message_of.h"
#include "abbe/study/compensation/frozen_file.h"

namespace abbe {
namespace {

using testing::HasSubstr;

FreezeRequest trunnion_to_freeze() {
  const std::string examples = ABBE_SOURCE_DIR "/examples/";
  FreezeRequest request;
  request.machine = read_machine(examples + "machines/trunnion-mill.machine.toml");
  request.errors_file = "trunnion.errors.toml";
  request.errors = read_errors(examples + "compensate/trunnion.errors.toml", request.machine);
  return request;
}

TEST(FrozenErrorsOfARequest, AreThoseOfTheRequestAndNeedItNoLonger) {
  const FrozenErrors result = [] {
    FreezeRequest request = trunnion_to_freeze();
    request.limit_um = 1e6;
    return freeze_errors(request);
  }();
  EXPECT_EQ(result.refused, "");
  EXPECT_GT(result.bytes().size(), 1000U);
  EXPECT_GT(result.frozen.largest_correction, 1e-3);
  EXPECT_LT(result.frozen.difference, 1e-9);
  EXPECT_EQ(result.errors.parameter_count(), trunnion_to_freeze().errors.errors.parameter_count());
  const std::string text = frozen_errors_text(result, {.file = "mill.abbec"});
  EXPECT_THAT(text, HasSubstr(": errors of trunnion.errors.toml frozen\n  mill.abbec: "));
  EXPECT_THAT(text, HasSubstr("tools of 0 to 300 mm\n"));
  const nlohmann::ordered_json json = frozen_errors_json(result, {.file = "mill.abbec", .written = false});
  EXPECT_EQ(json["bytes"], result.bytes().size());
  EXPECT_EQ(json["output"], "mill.abbec");
  EXPECT_EQ(json["written"], false);
  EXPECT_EQ(json["largest_correction_um"], 1e3 * result.frozen.largest_correction);
}

TEST(FrozenErrorsOfARequest, AreRefusedAboveTheLimit) {
  FreezeRequest request = trunnion_to_freeze();
  request.limit_um = 0.5;
  const FrozenErrors result = freeze_errors(request);
  EXPECT_THAT(result.refused, HasSubstr("um, above --limit-um 0.5, at C 180 deg, "));
  EXPECT_THAT(frozen_errors_text(result, {.written = false, .dry_run = true}), HasSubstr("dry run, nothing written: "));
}

TEST(FrozenErrorsOfARequest, LeaveOutWhatIsUncertain) {
  FreezeRequest request = trunnion_to_freeze();
  request.leave_out_factor = 2;
  const FrozenErrors result = freeze_errors(request);
  EXPECT_THAT(result.left_out.names, testing::Contains("EAX"));
  EXPECT_GT(result.frozen.accuracy, 1e-4);
  EXPECT_LT(result.frozen.difference, 1e-9);
  EXPECT_THAT(frozen_errors_text(result, {}), HasSubstr("by the full model with what is left out: "));
}

TEST(FrozenErrorsOfARequest, WhatIsOutOfRangeIsNamedByItsOption) {
  const auto problem = [](const auto& change) {
    FreezeRequest request = trunnion_to_freeze();
    change(request);
    return message_of([&] { freeze_errors(request); });
  };
  EXPECT_THAT(problem([](FreezeRequest& r) { r.limit_um = 0; }), HasSubstr("--limit-um: 0 is not a limit"));
  EXPECT_THAT(problem([](FreezeRequest& r) { r.limit_um = std::nan(""); }), HasSubstr("--limit-um: nan"));
  EXPECT_THAT(problem([](FreezeRequest& r) { r.largest_turn = 0.2; }), HasSubstr("--largest-turn-deg: out of range"));
  EXPECT_THAT(problem([](FreezeRequest& r) { r.tool_length_min = 400; }), HasSubstr("--tool-length-mm: the range is"));
  EXPECT_THAT(problem([](FreezeRequest& r) { r.tool = Eigen::Vector3d(0, 0, std::nan("")); }), HasSubstr("--tool-mm"));
  EXPECT_THAT(problem([](FreezeRequest& r) { r.leave_out_factor = -1; }), HasSubstr("--leave-out-below-uncertainty"));
  const std::string unknown = problem([](FreezeRequest& r) {
    r.errors = {};
    r.leave_out_factor = 1;
  });
  EXPECT_THAT(unknown, HasSubstr("trunnion.errors.toml: no standard uncertainties are stated"));
}

TEST(AFrozenFile, TellsWhatItIsForAndIsRefusedIfDamaged) {
  const FrozenErrors result = freeze_errors(trunnion_to_freeze());
  const CheckedFrozenFile frozen = check_frozen_file(result.bytes(), "mill.abbec");
  EXPECT_EQ(frozen.axes.size(), trunnion_to_freeze().machine.axes.size());
  const std::string text = frozen_file_text(frozen);
  EXPECT_THAT(text, HasSubstr("mill.abbec: frozen compensation of trunnion mill, whole\n"));
  EXPECT_THAT(text, HasSubstr("  A   travel -120 to 30 deg"));
  EXPECT_EQ(frozen_file_json(frozen).at("bytes"), result.bytes().size());
  std::string damaged(result.bytes());
  damaged.pop_back();
  EXPECT_THAT(message_of([&] { static_cast<void>(check_frozen_file(damaged, "mill.abbec")); }),
              HasSubstr("expected a whole file of abbe compensate freeze"));
}

}  // namespace
}  // namespace abbe
