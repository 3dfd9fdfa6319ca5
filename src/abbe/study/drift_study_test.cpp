#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "abbe/formats/files/empty_folder_for_test.h"
#include "abbe/formats/study/study_file.h"
#include "abbe/formats/text/message_of.h"
#include "abbe/geometry/decompositions.h"
#include "abbe/study/identification/drift_words.h"
#include "abbe/study/identification/setup_drifts.h"
#include "abbe/study/report/summary.h"
#include "abbe/study/run_study.h"
#include "abbe/study/study_steps.h"

namespace abbe {
namespace {

using testing::HasSubstr;

const char* const kTable = R"(name = "cross table"
chain = "w X' Y' b Z t"
[axis.X]
travel_mm = [0, 600]
[axis.Y]
travel_mm = [0, 400]
[axis.Z]
travel_mm = [0, 300]
)";

const char* const kTrueErrors = R"([[motion]]
name = "EXX"
basis = "legendre"
order = 2
coefficients_um = [0, 9, -4]
[[location]]
name = "EC0Y"
value_urad = 30
)";

/// A tracker beside the table reads three reflectors at 40 poses, two minutes apart.
std::filesystem::path table_folder(const char* name) {
  const std::filesystem::path folder = test::empty_folder(name);
  std::ofstream(folder / "table.machine.toml") << kTable;
  std::ofstream(folder / "truth.errors.toml") << kTrueErrors;
  std::ofstream poses(folder / "poses.csv");
  poses << "time_s,X_mm,Y_mm,Z_mm\n";
  RandomStream random(12);
  for (int k = 0; k < 40; ++k) {
    const double x = k == 0 ? 0 : k == 1 ? 600 : random.uniform(0, 600);
    poses << fmt::format("{},{:.3f},{:.3f},{:.3f}\n", 1000 + 120 * k, x, random.uniform(0, 400),
                         random.uniform(0, 300));
  }
  return folder;
}

std::string table_study(const std::string& drift, const std::string& identify = "held_out_fraction = 0\n",
                        double noise_um = 2) {
  return fmt::format(R"(machine = "table.machine.toml"
[simulate]
errors = "truth.errors.toml"
[[setup]]
name = "tracker"
instrument = "tracker"
mounted_on = "bed"
noise = {{ xyz_um = {} }}
{}
[[setup.station]]
name = "S1"
true_pose = {{ position_mm = [-700, 300, 200], angles_deg = [2, -3, 40] }}
[[setup.reflector]]
name = "R1"
mounted_on = "workpiece"
offset_mm = [0, 0, 0]
[[setup.reflector]]
name = "R2"
mounted_on = "workpiece"
offset_mm = [250, 60, -40]
[[setup.reflector]]
name = "R3"
mounted_on = "tool"
offset_mm = [-80, 220, 90]
[[setup.plan]]
kind = "poses"
file = "poses.csv"
[identify]
locations = ["EC0Y"]
{}
[[identify.motion]]
errors = "EXX"
basis = "legendre"
order = 2
)",
                     noise_um, drift, identify);
}

Study study_of(const std::filesystem::path& folder, const std::string& text, std::uint64_t seed = 1) {
  const std::filesystem::path file = folder / "table.study.toml";
  std::ofstream(file) << text;
  Study study = read_study(file);
  study.seed = seed;
  return study;
}

StudyResult identified(const Study& study) {
  StudyResult result;
  result.campaign = gather_readings(study);
  prepare_study(study, result);
  result.walks = walks_to_estimate(result.campaign, result.model.problem);
  result.identification = result.walks.empty() ? identify(result.model.problem, identify_options(study))
                                               : identify_with_walks(result.model.problem, result.walks);
  return result;
}

/// (estimates - truth)' C^-1 (estimates - truth) over some parameters.
double chi_square_of(const Identification& found, const std::vector<std::string>& names,
                     const std::vector<double>& truth) {
  std::vector<Eigen::Index> at;
  for (const std::string& name : names) {
    for (std::size_t p = 0; p < found.parameters.size(); ++p) {
      if (found.parameters[p].name == name) at.push_back(static_cast<Eigen::Index>(p));
    }
  }
  EXPECT_EQ(at.size(), names.size());
  Eigen::VectorXd difference = found.estimates(at);
  for (std::size_t i = 0; i < truth.size(); ++i) difference[static_cast<Eigen::Index>(i)] -= truth[i];
  const Eigen::VectorXd scale = found.covariance.diagonal()(at).cwiseSqrt().cwiseInverse();
  const Eigen::VectorXd scaled = scale.cwiseProduct(difference);
  const Eigen::MatrixXd correlation = scale.asDiagonal() * found.covariance(at, at) * scale.asDiagonal();
  return scaled.dot(Cholesky(correlation).solve(scaled));
}

constexpr int kDraws = 200;

TEST(DriftStudy, APolynomialIsFoundWithTheUncertaintyThatIsStated) {
  const std::filesystem::path folder = table_folder("drift_polynomial");
  Study study = study_of(folder, table_study(R"([setup.drift]
components = ["x", "y", "z", "rz"]
degree = 2
[setup.drift.true]
x_um = [40, -15]
y_um = [-25]
rz_urad = [30, 12]
)"));
  double of_parameters = 0, of_readings = 0, freedom = 0, within = 0;
  for (int draw = 0; draw < kDraws; ++draw) {
    study.seed = 100 + static_cast<std::uint64_t>(draw);
    const StudyResult result = identified(study);
    ASSERT_TRUE(result.usable()) << result.identification.message;
    of_parameters += chi_square_of(result.identification,
                                   {"S1.drift_x[P1]", "S1.drift_x[P2]", "S1.drift_y[P1]", "S1.drift_rz[P1]",
                                    "S1.drift_rz[P2]", "EXX[P1]", "EXX[P2]", "EC0Y"},
                                   {0.040, -0.015, -0.025, 30e-6, 12e-6, 0.009, -0.004, 30e-6});
    of_readings += result.identification.statistics.chi_square;
    freedom += result.identification.statistics.degrees_of_freedom;
    const FoundDrift x = found_drifts(result).front();
    within += std::abs(x.value.back() - 0.025) <= x.expanded.back() ? 1 : 0;
  }
  EXPECT_NEAR(of_parameters / kDraws, 8, 4 * std::sqrt(2 * 8.0 / kDraws));
  EXPECT_NEAR(of_readings / freedom, 1, 4 * std::sqrt(2 / freedom));
  EXPECT_NEAR(within / kDraws, 0.954, 4 * std::sqrt(0.954 * 0.046 / kDraws));
}

TEST(DriftStudy, AStatedWalkIsFoundWithTheUncertaintyThatIsStated) {
  const std::filesystem::path folder = table_folder("drift_walk");
  Study study = study_of(folder, table_study(R"([setup.drift]
components = ["x", "y", "rz"]
random_walk_um_per_sqrt_h = 12
random_walk_urad_per_sqrt_h = 20
knots = 60
[setup.drift.true]
random_walk_um_per_sqrt_h = 12
random_walk_urad_per_sqrt_h = 20
)"));
  // The truth wanders in all six motions; those that are not identified must stand still.
  double of_parameters = 0, count = 0, of_readings = 0, freedom = 0, within = 0, values = 0;
  for (int draw = 0; draw < kDraws; ++draw) {
    study.seed = 300 + static_cast<std::uint64_t>(draw);
    StudyResult result;
    study.setups[0].drift->components = {0, 1, 2, 3, 4, 5};
    result = identified(study);
    ASSERT_TRUE(result.usable()) << result.identification.message;
    const SetupDrift& truth = *result.campaign.setups[0].true_drift;
    std::vector<std::string> names;
    std::vector<double> expected;
    const SetupDrift& assumed = *result.campaign.setups[0].readings.drift;
    ASSERT_EQ(assumed.places[0].knots_s, truth.places[0].knots_s);
    const std::vector<SetupUnknown> unknowns = assumed.unknowns();
    const std::size_t knots = assumed.places[0].knots_s.size() - 1;
    for (std::size_t u = 0; u < unknowns.size(); u += 13) {
      names.push_back(unknowns[u].name);
      const std::size_t component = u / knots;
      expected.push_back(truth.values[truth.first_unknown(0, component) + 3 + u % knots]);
    }
    of_parameters += chi_square_of(result.identification, names, expected);
    count += static_cast<double>(names.size());
    of_readings += result.identification.statistics.chi_square;
    freedom += result.identification.statistics.degrees_of_freedom;
    const std::vector<FoundDrift> found = found_drifts(result);
    for (std::size_t c = 0; c < 6; ++c) {
      const double end = truth.values[truth.first_unknown(0, c) + 3 + knots - 1];
      within += std::abs(found[c].value.back() - end) <= found[c].expanded.back() ? 1 : 0;
      values += 1;
    }
  }
  EXPECT_NEAR(of_parameters / count, 1, 4 * std::sqrt(2 / count));
  EXPECT_NEAR(of_readings / freedom, 1, 4 * std::sqrt(2 / freedom));
  EXPECT_NEAR(within / values, 0.954, 4 * std::sqrt(0.954 * 0.046 / kDraws));
}

TEST(DriftStudy, TheIntensityOfAWalkIsEstimated) {
  const std::filesystem::path folder = table_folder("drift_intensity");
  Study study = study_of(folder, table_study(R"([setup.drift]
components = ["x", "y", "z", "rx", "ry", "rz"]
random_walk = "estimated"
random_walk_um_per_sqrt_h = 8  # where the search starts
random_walk_urad_per_sqrt_h = 30
knots = 60
[setup.drift.true]
random_walk_um_per_sqrt_h = 12
random_walk_urad_per_sqrt_h = 20
)"));
  const double truth[] = {12e-3 * 12e-3 / 3600, 20e-6 * 20e-6 / 3600};
  constexpr int kFewer = 40;
  double mean[2] = {0, 0}, squares[2] = {0, 0};
  for (int draw = 0; draw < kFewer; ++draw) {
    study.seed = 600 + static_cast<std::uint64_t>(draw);
    const StudyResult result = identified(study);
    ASSERT_TRUE(result.usable()) << result.identification.message;
    ASSERT_EQ(result.walks.size(), 2U);
    for (std::size_t w = 0; w < 2; ++w) {
      const double deviation = (result.walks[w].variance - truth[w]) / result.walks[w].variance_uncertainty;
      mean[w] += result.walks[w].variance / truth[w] / kFewer;
      squares[w] += deviation * deviation / kFewer;
    }
  }
  for (std::size_t w = 0; w < 2; ++w) {
    EXPECT_NEAR(mean[w], 1, 0.12) << w;
    EXPECT_GT(squares[w], 0.6) << w;
    EXPECT_LT(squares[w], 1.6) << w;
  }
}

TEST(DriftStudy, AStationThatStandsStillHasNoWalk) {
  const std::filesystem::path folder = table_folder("drift_none");
  const Study study = study_of(folder, table_study("[setup.drift]\nrandom_walk = \"estimated\"\n"), 3);
  const StudyResult result = identified(study);
  ASSERT_TRUE(result.usable()) << result.identification.message;
  ASSERT_EQ(result.walks.size(), 1U);
  // In an hour far less than a reading shows.
  EXPECT_TRUE(result.walks[0].at_zero || std::sqrt(3600 * result.walks[0].variance) < 1e-3);
  EXPECT_LT(std::sqrt(3600 * result.walks[0].variance), 2e-3);
}

/// Without the drift in the model the readings are not explained; with it they are, and the report says how far.
TEST(DriftStudy, IsReported) {
  const std::filesystem::path folder = table_folder("drift_report");
  const std::string truth = "[setup.drift.true]\nx_um = [80]\n";
  const StudyResult without = run_study(study_of(folder, table_study("[setup.drift]\n" + truth)));
  EXPECT_GT(without.identification.statistics.variance_factor, 3);
  const Study study = study_of(folder, table_study("[setup.drift]\ndegree = 1\n" + truth, "held_out_fraction = 0.1\n"));
  const StudyResult with = run_study(study);
  ASSERT_TRUE(with.usable());
  EXPECT_LT(with.identification.statistics.variance_factor, 1.3);
  EXPECT_THAT(study_text(study, with, nullptr), HasSubstr("drift of the set-ups since their first reading"));
  const nlohmann::ordered_json json = study_summary(study, with);
  EXPECT_NEAR(json["drift"]["places"][0]["value_um"].back().get<double>(), 80, 6);
  EXPECT_EQ(json["drift"]["places"][0]["motion"], "x");
}

/// What moves between blocks and is in no model is noise that the readings of a block have in common.
TEST(DriftStudy, LeavesNoiseThatIsCommonToABlockOfTime) {
  const std::filesystem::path folder = table_folder("drift_blocks");
  const std::string drift = "[setup.drift]\n[setup.drift.true]\nrandom_walk_um_per_sqrt_h = 40\n";
  const std::string block = "held_out_fraction = 0\nblock_noise = \"estimated\"\nnoise_block_min = 2\n";
  const Study study = study_of(folder, table_study(drift, block), 4);
  const StudyResult result = run_study(study);
  ASSERT_TRUE(result.usable()) << result.identification.message;
  const nlohmann::ordered_json json = study_summary(study, result)["reading_variances"];
  EXPECT_GT(json["block_noise_um"].get<double>(), 5);
  EXPECT_FALSE(json["block_noise_at_zero"].get<bool>());
  EXPECT_THAT(study_text(study, result, nullptr), HasSubstr("noise common to a block of time"));
  const StudyResult still = run_study(study_of(folder, table_study("", block), 4));
  EXPECT_LT(still.weighed->components.pose_noise(), 1e-3);
}

TEST(DriftStudy, RefusesWhatCannotDrift) {
  const std::filesystem::path folder = table_folder("drift_refused");
  const auto said = [&](const std::string& drift) { return message_of([&] { study_of(folder, table_study(drift)); }); };
  EXPECT_THAT(said("[setup.drift]\n"), HasSubstr("nothing is said to drift"));
  EXPECT_THAT(said("[setup.drift]\ncomponents = [\"u\"]\ndegree = 1\n"), HasSubstr("not a motion of a set-up"));
  EXPECT_THAT(said("[setup.drift]\ncomponents = [\"rx\"]\nrandom_walk_um_per_sqrt_h = 1\n"),
              HasSubstr("random_walk_urad_per_sqrt_h"));
  EXPECT_THAT(message_of([&] {
                study_of(folder, table_study("[setup.drift]\nrandom_walk = \"estimated\"\n", "loss = \"huber\"\n"));
              }),
              HasSubstr("random walk of tracker is estimated beside"));
  EXPECT_THAT(said("[setup.drift]\ndegree = 4\n"), HasSubstr("degree"));
  EXPECT_THAT(said("[setup.drift]\nrandom_walk = \"stated\"\n"), HasSubstr("random_walk_um_per_sqrt_h"));
}

}  // namespace
}  // namespace abbe
