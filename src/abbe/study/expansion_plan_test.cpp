#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "abbe/formats/files/empty_folder_for_test.h"
#include "abbe/formats/study/study_file.h"
#include "abbe/study/planning/planning.h"

namespace abbe {
namespace {

StudyPlan expansion_plan(const std::string& knowledge) {
  const std::filesystem::path folder = test::empty_folder("expansion_plan");
  std::ofstream(folder / "slide.machine.toml") << R"(name = "slide"
chain = "w b X Z t"
[axis.X]
travel_mm = [0, 1000]
[axis.Z]
travel_mm = [0, 600]
[state.hall]
kind = "measured"
unit = "degC"
)";
  std::ofstream(folder / "slide.study.toml") << R"(machine = "slide.machine.toml"
seed = 4
threads = 1
[[setup]]
name = "tracker"
instrument = "tracker"
mounted_on = "bed"
noise = { xyz_um = 2 }
[[setup.station]]
name = "station"
pose = { position_mm = [1500, -2200, 300], angles_deg = [0.4, -0.8, 70] }
[[setup.reflector]]
name = "R1"
offset_mm = [0, 0, 0]
[[setup.reflector]]
name = "R2"
offset_mm = [120, 40, -60]
[[setup.reflector]]
name = "R3"
offset_mm = [-80, -50, 90]
[plan]
poses = 60
readings = 20
[plan.state.hall]
values = [18, 20, 24]
[identify]
[[identify.motion]]
errors = ["EXX", "EZZ"]
basis = "legendre"
order = 2
[[identify.expansion]]
axis = "X"
state = "hall"
)" << knowledge;
  return plan_study(read_study(folder / "slide.study.toml"));
}

TEST(ExpansionPlan, AKnownCoefficientNeedsOneTemperatureAndAnOpenOneTwo) {
  const StudyPlan open = expansion_plan("estimate_coefficient = true\n");
  ASSERT_EQ(open.plan.status, PlanningStatus::done);
  ASSERT_GE(open.condition_curve.size(), 2U);
  EXPECT_EQ(open.condition_curve[0].open, 1U);
  EXPECT_EQ(open.conditions.conditions.size(), 2U);

  const StudyPlan known =
      expansion_plan("coefficient_um_per_m_K = 10\ncoefficient_standard_uncertainty_um_per_m_K = 0.001\n");
  ASSERT_EQ(known.plan.status, PlanningStatus::done);
  EXPECT_EQ(known.condition_curve.at(0).open, 0U);
  EXPECT_EQ(known.conditions.conditions.size(), 1U);
  EXPECT_LT(known.conditions.with_prior, open.condition_curve[0].with_prior / 3);
}

}  // namespace
}  // namespace abbe
