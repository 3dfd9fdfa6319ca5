// Points of PCD and E57 files: the same answers as from a CSV file, and what is not in them is said.
#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>

#include "abbe/formats/shapes/e57_for_test.h"
#include "abbe/formats/shapes/pcd_for_test.h"
#include "abbe/formats/shapes/point_cloud_file.h"
#include "cli/command_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

/// Writes the points of an example as CSV, PCD in all forms (mm) and E57 (m), with two points of no coordinates in all
/// but the CSV file. Coordinates are multiples of 2^-10 mm, which a float has exactly.
class PointClouds : public CommandTest {
 protected:
  void write_clouds(const std::string& example) {
    PointCloud cloud = read_point_cloud(std::filesystem::path(ABBE_SOURCE_DIR) / "examples" / example).cloud;
    cloud.points = (1024 * cloud.points).array().round() / 1024;
    folder.write("cloud.csv", point_cloud_csv(cloud));
    std::vector<std::vector<double>> mm(3), m(3);
    std::vector<std::int64_t> states;
    for (Eigen::Index i = 0; i < cloud.size(); ++i) {
      const bool is_before_nothing = i == 3 || i + 1 == cloud.size();
      for (std::size_t k = 0; k < 3; ++k) {
        const double value = cloud.points(static_cast<Eigen::Index>(k), i);
        mm[k].push_back(value);
        m[k].push_back(1e-3 * value);
        if (!is_before_nothing) continue;
        mm[k].push_back(kNothing);
        m[k].push_back(0);
      }
      states.push_back(0);
      if (is_before_nothing) states.push_back(2);
    }
    const std::size_t points = states.size();
    for (const std::string form : {"ascii", "binary", "binary_compressed"}) {
      folder.write(form + ".pcd", pcd_for_test({{"x", 'F', 4, 1, mm[0]},
                                                {"y", 'F', 4, 1, mm[1]},
                                                {"z", 'F', 4, 1, mm[2]},
                                                {"rgb", 'U', 4, 1, std::vector<double>(points, 255)}},
                                               points, form));
    }
    E57ScanForTest scan;
    scan.points = points;
    scan.packets = 9;
    scan.fields = {e57_float_for_test("cartesianX", false, m[0]), e57_float_for_test("cartesianY", false, m[1]),
                   e57_float_for_test("cartesianZ", false, m[2]),
                   e57_integer_for_test("cartesianInvalidState", 0, 2, "", states)};
    folder.write("cloud.e57", e57_for_test({scan}));
  }

  nlohmann::json json_of(const std::vector<std::string>& arguments) const {
    const CommandResult result = abbe(arguments);
    EXPECT_EQ(result.exit_code, ExitCode::done) << result.err;
    return nlohmann::json::parse(result.out, nullptr, false);
  }

  const std::vector<std::string> others = {"ascii.pcd", "binary.pcd", "binary_compressed.pcd", "cloud.e57"};
};

TEST_F(PointClouds, AFitIsThatOfTheSamePointsAsCsv) {
  write_clouds("fit/bore.csv");
  const nlohmann::json expected = json_of({"fit", "cloud.csv", "--shape", "cylinder", "--json"});
  ASSERT_GT(expected.at("figures").size(), 5U);
  for (const std::string& file : others) {
    const nlohmann::json found = json_of({"fit", file, "--shape", "cylinder", "--json"});
    for (const auto& [name, figure] : expected.at("figures").items()) {
      for (const auto& [key, value] : figure.items()) {
        if (!value.is_number()) continue;
        const double a = value, b = found.at("figures").at(name).at(key);
        EXPECT_NEAR(a, b, 1e-9 * (1 + std::abs(a))) << file << " " << name << " " << key;
      }
    }
    const CommandResult words = abbe({"fit", file, "--shape", "cylinder"});
    EXPECT_THAT(words.out, HasSubstr("2 points are left out: ")) << file;
  }
  EXPECT_THAT(abbe({"fit", "cloud.e57", "--shape", "cylinder"}).out, HasSubstr("E57, 1 scan, m (stated by the file)"));
}

TEST_F(PointClouds, ARegistrationIsThatOfTheSamePointsAsCsv) {
  write_clouds("scan/bracket-scan.csv");
  const std::string part = ABBE_SOURCE_DIR "/examples/scan/bracket.stl";
  const auto placed = [&](const std::string& file) {
    const CommandResult result = abbe({"register", file, part, "-o", file + "-results"});
    EXPECT_EQ(result.exit_code, ExitCode::done) << result.err;
    EXPECT_EQ(result.out.find("2 points are left out: ") == std::string::npos, file == "cloud.csv") << result.out;
    return read_point_cloud(folder.path() / (file + "-results") / "registered.ply").cloud.points;
  };
  const Eigen::Matrix3Xd expected = placed("cloud.csv");
  for (const std::string& file : others) {
    const Eigen::Matrix3Xd found = placed(file);
    ASSERT_EQ(found.cols(), expected.cols()) << file;
    EXPECT_LT((found - expected).cwiseAbs().maxCoeff(), 1e-8) << file;
  }
  EXPECT_EQ(placed("binary.pcd"), expected);
  const CommandResult deviated = abbe({"deviate", "cloud.e57", part, "--transform", "cloud.csv-results/transform.csv"});
  EXPECT_EQ(deviated.exit_code, ExitCode::done) << deviated.err;
  EXPECT_THAT(deviated.out, HasSubstr("2 points are left out: the file marks their coordinates as invalid"));
  EXPECT_THAT(abbe({"register", "cloud.e57", part, "--scan-unit", "mm"}).err,
              HasSubstr("the file states m, but mm was given"));
}

TEST_F(PointClouds, TheCheckSaysWhatIsInAFile) {
  write_clouds("fit/bore.csv");
  const nlohmann::json csv = json_of({"check", "cloud.csv", "--json"});
  EXPECT_EQ(csv.at("points_left_out"), 0);
  for (const std::string& file : others) {
    const nlohmann::json json = json_of({"check", file, "--json"});
    EXPECT_EQ(json.at("kind"), "point_cloud");
    EXPECT_EQ(json.at("points"), csv.at("points")) << file;
    EXPECT_EQ(json.at("points_left_out"), 2);
    EXPECT_EQ(json.at("notes").size(), 1U);
    EXPECT_NEAR(json.at("upper_mm")[0].get<double>(), csv.at("upper_mm")[0].get<double>(), 1e-9);
    EXPECT_THAT(abbe({"check", file}).out, HasSubstr("\nnote: 2 points are left out: "));
  }
  EXPECT_EQ(json_of({"check", "cloud.e57", "--json"}).at("file_unit_is"), "stated");
  EXPECT_NEAR(json_of({"check", "binary.pcd", "--unit", "m", "--json"}).at("upper_mm")[0].get<double>(),
              1000 * csv.at("upper_mm")[0].get<double>(), 1e-6);
  // Contents tell the kind where there is no name.
  for (const std::string& file : others) {
    const CommandResult read = run_program("/bin/sh", {"-c", ABBE_COMMAND " check - < " + file}, folder.path());
    EXPECT_EQ(read.out, abbe({"check", file}).out);
  }
}

TEST_F(PointClouds, DamageIsBadInput) {
  write_clouds("fit/bore.csv");
  std::string damaged = folder.read("cloud.e57");
  damaged[3000] ^= 4;
  folder.write("damaged.e57", damaged);
  const CommandResult result = abbe({"check", "damaged.e57"});
  EXPECT_EQ(result.exit_code, ExitCode::bad_input);
  EXPECT_THAT(result.err, HasSubstr("damaged.e57: checksum: at byte 3068: the file is damaged"));
  folder.write("short.pcd", folder.read("binary.pcd").substr(0, 500));
  EXPECT_THAT(abbe({"check", "short.pcd"}).err, HasSubstr("short.pcd:10: POINTS: "));
}

}  // namespace
}  // namespace abbe
