#include "abbe/study/compensation/errors_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/text/message_of.h"

namespace abbe {
namespace {

using testing::HasSubstr;

ErrorsMapRequest trunnion_errors() {
  const std::string examples = ABBE_SOURCE_DIR "/examples/";
  ErrorsMapRequest request;
  request.machine = read_machine(examples + "machines/trunnion-mill.machine.toml");
  request.errors = read_errors(examples + "compensate/trunnion.errors.toml", request.machine);
  // Three positions of two axes and one of the others.
  request.grid.resize(request.machine.axes.size());
  for (std::size_t axis = 0; axis < request.grid.size(); ++axis) request.grid[axis] = AxisRange::fixed(0);
  request.grid[request.machine.find_axis("X")] = AxisRange{-50, 50, 3, 0};
  request.grid[request.machine.find_axis("Y")] = AxisRange{-50, 50, 3, 0};
  return request;
}

TEST(ErrorsMapOfAFile, HoldsThePosesThatWereAskedFor) {
  const ErrorsMap map = map_errors(trunnion_errors());
  EXPECT_EQ(map.stated.poses.count(), 9U);
  EXPECT_EQ(map.left_out().all, 9U);
  EXPECT_EQ(map.before.statistics.count, 9U);
  ASSERT_TRUE(map.figures && map.figures->predicted_before);
  EXPECT_DOUBLE_EQ(map.figures->predicted_before->maximum, map.before.statistics.maximum);
  EXPECT_EQ(errors_map_json(map)["poses"], 9);
  EXPECT_THAT(errors_map_text(map), testing::StartsWith("9 poses of " + map.machine.name));
  EXPECT_EQ(errors_map_data(map).points[0].size(), 9U);
}

TEST(ErrorsMapOfAFile, TheSameErrorsCorrectedForLeaveNothing) {
  ErrorsMapRequest request = trunnion_errors();
  request.minus = request.errors;
  for (const bool fit : {true, false}) {
    request.fit_datum = fit;
    const ErrorsMap map = map_errors(request);
    EXPECT_GT(map.before.statistics.mean, 1e-3);
    ASSERT_TRUE(map.after);
    EXPECT_LT(map.after->statistics.maximum, 1e-12);
    EXPECT_EQ(map.figures.has_value(), fit);
    EXPECT_EQ(errors_map_json(map).contains("displacement_after_um"), !fit);
  }
}

TEST(ErrorsMapOfAFile, PosesStandForTheGrid) {
  ErrorsMapRequest request = trunnion_errors();
  request.poses.emplace();
  request.poses->words = "two poses";
  request.poses->poses.axis.assign(request.machine.axes.size(), {0, 0});
  request.poses->poses.axis[request.machine.find_axis("X")] = {0, 10};
  request.fit_datum = false;
  const ErrorsMap map = map_errors(request);
  EXPECT_EQ(map.before.count(), 2U);
  EXPECT_FALSE(map_is_structured(errors_map_data(map)));
}

TEST(ErrorsMapOfAFile, IsStoppedAndRefusedForTooManyPoses) {
  ErrorsMapRequest request = trunnion_errors();
  std::stop_source source;
  JobOptions options;
  options.stop = source.get_token();
  options.progress = [&](std::size_t done, std::size_t total) {
    EXPECT_LE(done, total);
    source.request_stop();
  };
  EXPECT_THROW(map_errors(request, options), Stopped);
  request.grid[request.machine.find_axis("X")]->count = 1000000;
  request.grid[request.machine.find_axis("Y")]->count = 1000;
  EXPECT_THAT(message_of([&] { map_errors(request); }), HasSubstr("--grid: 1000000000 poses"));
}

}  // namespace
}  // namespace abbe
