#include "abbe/study/planning/planning.h"

#include <gtest/gtest.h>

#include <memory>
#include <stop_token>

#include "abbe/formats/study/study_file.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/study/campaign.h"
#include "abbe/study/example_file_for_test.h"
#include "abbe/study/random_poses.h"
#include "abbe/study/study_check.h"

namespace abbe {
namespace {

/// A plan of an example, of fewer readings from fewer candidates.
Study small_plan() {
  Study study = read_study(test::example_file("trunnion/trunnion.study.toml"));
  study.planning->candidates = 150;
  study.planning->readings = 60;
  study.threads = 1;
  return study;
}

TEST(PlanStudy, StopsWhereThatIsAskedFor) {
  const Study study = small_plan();
  std::size_t calls = 0, before = 0;
  const StudyPlan plan = plan_study(study, {.progress = [&](std::size_t done, std::size_t total) {
                                      ++calls;
                                      EXPECT_LE(before, done);
                                      EXPECT_LE(done, total);
                                      before = done;
                                    }});
  EXPECT_EQ(plan.plan.status, PlanningStatus::done);
  EXPECT_EQ(before, 1000U);
  // At its beginning, while readings are exchanged, and before the grids that it is compared with.
  for (const std::size_t last : {std::size_t{1}, calls / 2, calls - 1}) {
    std::stop_source source;
    std::size_t told = 0;
    const auto progress = [&](std::size_t, std::size_t) {
      if (++told == last) source.request_stop();
    };
    EXPECT_THROW(plan_study(study, {.progress = progress, .stop = source.get_token()}), Stopped) << last;
    EXPECT_EQ(told, last);
  }
}

TEST(PlanStudy, StopsBeforeItBeginsAndWithoutProgress) {
  std::stop_source source;
  source.request_stop();
  EXPECT_THROW(plan_study(small_plan(), {.stop = source.get_token()}), Stopped);
}

TEST(PlanStudy, StopsWhileSetUpsAreCompared) {
  Study study = small_plan();
  study.setups.push_back(study.setups.front());
  study.setups.back().name = "second";
  study.planning->time = 7200;
  for (const auto& setup : study.setups) {
    PlannedSetup& cost = study.planning->setups.emplace_back();
    cost.name = setup.name;
    cost.set_up = 60;
  }
  std::stop_source source;
  const auto progress = [&](std::size_t done, std::size_t) {
    EXPECT_LT(done, 500U);
    if (done > 0) source.request_stop();  // after the first combination
  };
  EXPECT_THROW(plan_study(study, {.progress = progress, .stop = source.get_token()}), Stopped);
}

TEST(PlanningModel, DoesNotNeedTheStudyThatItIsOf) {
  std::unique_ptr<const PlanningModel> model;
  {
    const auto passing = std::make_unique<const Study>(small_plan());
    model = std::make_unique<const PlanningModel>(*passing);
  }
  const Study study = small_plan();
  const PlanningModel own(study);
  const PoseList poses = random_plan(study.machine, study.planning->axes, 20, 3);
  EXPECT_EQ(model->prediction_rows(poses), own.prediction_rows(poses));
  EXPECT_EQ(model->readings_at(poses).rows.rows, own.readings_at(poses).rows.rows);
  EXPECT_EQ(model->study().name, study.name);
}

TEST(GatherReadings, StopsWhileReadingsAreSimulated) {
  const Study study = read_study(test::example_file("trunnion/trunnion.study.toml"));
  ASSERT_TRUE(study.simulation);
  std::stop_source source;
  const auto progress = [&](std::size_t, std::size_t) { source.request_stop(); };
  EXPECT_THROW(gather_readings(study, {.progress = progress, .stop = source.get_token()}), Stopped);
  EXPECT_THROW(check_study(study, {.stop = source.get_token()}), Stopped);
  EXPECT_GT(check_study(study).campaign.reading_count(), 0U);
}

TEST(GatherReadings, StopsBeforeAFileIsRead) {
  Study study = read_study(test::example_file("trunnion/trunnion.study.toml"));
  study.simulation.reset();
  for (auto& setup : study.setups) setup.data.push_back({.file = "there-is-no-such-file.csv", .mapping = {}});
  EXPECT_THROW(gather_readings(study), InputError);
  std::stop_source source;
  source.request_stop();
  EXPECT_THROW(gather_readings(study, {.stop = source.get_token()}), Stopped);
}

}  // namespace
}  // namespace abbe
