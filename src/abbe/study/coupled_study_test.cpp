#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include "abbe/errors/random_stream.h"
#include "abbe/formats/files/empty_folder_for_test.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/study/study_file.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/study/run_study.h"

namespace abbe {
namespace {

/// A parallelogram drives the upper arm: B2 keeps its angle to the ground while B1 turns.
const char* const kParallelogram = R"(name = "parallelogram arm"
chain = "w b C B1 B2 t"
[axis.C]
travel_deg = [-150, 150]
[axis.B1]
travel_deg = [-60, 85]
point_mm = [100, 0, 615]
[axis.B2]
travel_deg = [-60, 60]
point_mm = [100, 0, 1320]
coupled = {{ B1 = {} }}
[tool]
reference_mm = [900, 0, 1450]

[state.lower]
kind = "axis"
axis = "B1"
)";

const char* const kTrueErrorsOfCoupled = R"([[motion]]
name = "EBC"
basis = "fourier"
order = 1
coefficients_urad = [0, 30, -20]
[[motion]]
name = "EZB2"
basis = "legendre"
order = 2
coefficients_um = [0, 25, -15]
[[location]]
name = "EC0B1"
value_urad = 60
[[location]]
name = "EC0B2"
value_urad = -45
[[location]]
name = "EB0B2"
value_urad = 80
)";

const char* const kCoupledStudy = R"(name = "arm"
machine = "{machine}"
seed = 5
{simulate}
[[setup]]
name = "tracker"
instrument = "tracker"
mounted_on = "bed"
noise = {{ xyz_um = 5 }}
{data}
[[setup.station]]
name = "station"
pose = "find"
{true_pose}
[[setup.reflector]]
name = "R1"
offset_mm = [0, 0, 0]
[[setup.reflector]]
name = "R2"
offset_mm = [40, 120, -60]
[[setup.reflector]]
name = "R3"
offset_mm = [-50, -80, 90]
{plan}
[identify]
locations = ["EC0B1", "EC0B2", "EB0B2"]
[[identify.motion]]
errors = "EBC"
basis = "fourier"
order = 1
[[identify.motion]]
errors = "EZB2"
basis = "legendre"
order = 2
[[identify.motion]]
errors = "EBB2"
state = "lower"
basis = "legendre"
order = 0
)";

std::filesystem::path coupled_folder(const char* name) {
  const std::filesystem::path folder = test::empty_folder(name);
  std::ofstream(folder / "nominal.machine.toml") << fmt::format(fmt::runtime(kParallelogram), -1);
  std::ofstream(folder / "wrong.machine.toml") << fmt::format(fmt::runtime(kParallelogram), -0.9998);
  std::ofstream(folder / "truth.errors.toml") << kTrueErrorsOfCoupled;
  std::ofstream poses(folder / "poses.csv");
  poses << "C_deg,B1_deg,B2_deg\n";
  RandomStream random(3);
  for (int k = 0; k < 200; ++k) {
    poses << fmt::format("{:.3f},{:.3f},{:.3f}\n", random.uniform(-150, 150), random.uniform(-60, 85),
                         random.uniform(-60, 60));
  }
  return folder;
}

Study coupled_study(const std::filesystem::path& folder, const char* machine, bool simulated) {
  const std::filesystem::path file = folder / (std::string(machine) + ".study.toml");
  std::ofstream(file) << fmt::format(
      fmt::runtime(kCoupledStudy), fmt::arg("machine", machine),
      fmt::arg("simulate", simulated ? "[simulate]\nerrors = \"truth.errors.toml\"" : ""),
      fmt::arg("data", simulated ? "" : "[[setup.data]]\nfile = \"readings.csv\""),
      fmt::arg("true_pose",
               simulated ? "true_pose = { position_mm = [1500, -2200, 300], angles_deg = [0.4, -0.8, 70] }" : ""),
      fmt::arg("plan", simulated ? "[[setup.plan]]\nkind = \"poses\"\nfile = \"poses.csv\"" : ""));
  return read_study(file);
}

/// Estimate of a parameter less its true value, in standard uncertainties.
double departure(const StudyResult& result, const std::string& name, double truth) {
  const auto& parameters = result.identification.parameters;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (parameters[i].name != name) continue;
    const auto index = static_cast<Eigen::Index>(i);
    const double u = result.identification.standard_uncertainties[index];
    EXPECT_GT(u, 0) << name;
    return (result.identification.estimates[index] - truth) / u;
  }
  ADD_FAILURE() << name << " is not identified";
  return 0;
}

/// Readings of a machine whose parallelogram has another ratio, identified on the machine as it should be: the ratio
/// comes out as an angle of B2 in proportion to the position of B1.
TEST(CoupledStudy, AWrongRatioAndTheErrorsAreRecovered) {
  const std::filesystem::path folder = coupled_folder("coupled_study");
  const Study wrong = coupled_study(folder, "wrong.machine.toml", true);
  std::ofstream(folder / "readings.csv") << gather_readings(wrong).setups[0].readings_text(wrong.machine);
  const Study study = coupled_study(folder, "nominal.machine.toml", false);
  const StudyResult result = run_study(study);
  ASSERT_TRUE(result.usable()) << result.identification.message;
  EXPECT_NEAR(result.identification.statistics.variance_factor, 1, 0.15);
  const auto names = [&] {
    std::string all;
    for (const auto& parameter : result.identification.parameters) all += parameter.name + " ";
    return all;
  };
  EXPECT_LE(std::abs(departure(result, "EBB2*lower[P0]", 2e-4)), 2) << names();
  EXPECT_LE(std::abs(departure(result, "EC0B2", -45e-6)), 2) << names();
  EXPECT_LE(std::abs(departure(result, "EB0B2", 80e-6)), 2) << names();
  EXPECT_LE(std::abs(departure(result, "EC0B1", 60e-6)), 2) << names();
  // The range of EZB2 is one of positions: the readings covered more than the travel of the command.
  for (const ErrorMotion& motion : result.identification.errors.motions) {
    if (motion.axis != 2 || motion.component != Component::Z) continue;
    EXPECT_LT(motion.basis.from, -120 * kDegree);
    EXPECT_GT(motion.basis.to, 100 * kDegree);
  }
  ASSERT_TRUE(result.map);
  EXPECT_GT(result.map->predicted.statistics.count, 50U);
}

/// Without the term for the ratio the readings are not explained.
TEST(CoupledStudy, AWrongRatioShowsInTheFit) {
  const std::filesystem::path folder = coupled_folder("coupled_study_without");
  const Study wrong = coupled_study(folder, "wrong.machine.toml", true);
  std::ofstream(folder / "readings.csv") << gather_readings(wrong).setups[0].readings_text(wrong.machine);
  Study study = coupled_study(folder, "nominal.machine.toml", false);
  std::erase_if(study.identification->motions, [](const IdentifiedMotion& motion) { return motion.state != kNoState; });
  EXPECT_GT(run_study(study).identification.statistics.variance_factor, 10);
}

}  // namespace
}  // namespace abbe
