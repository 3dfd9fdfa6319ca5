// abbe register and abbe deviate on the example scans.
#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>

#include "abbe/formats/machine/transform_file.h"
#include "abbe/formats/shapes/ply_file.h"
#include "cli/command_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;

class Scan : public CommandTest {
 protected:
  nlohmann::json json(std::vector<std::string> arguments, int exit_code) const {
    arguments.emplace_back("--json");
    const CommandResult result = abbe(arguments);
    EXPECT_EQ(result.exit_code, exit_code) << result.err;
    return nlohmann::json::parse(result.out, nullptr, false);
  }
  std::string file(const std::string& name) const { return std::string(ABBE_SOURCE_DIR "/examples/scan/") + name; }
};

/// Pose in which examples/scan/make_scan.py lays the bracket.
RigidTransform part_from_bracket_scan() {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(2.2, Eigen::Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
  return RigidTransform{turn, {120, -40, 310}}.inverse();
}

TEST_F(Scan, TheBracketIsFoundFromAnywhereWithItsUncertainty) {
  const auto found = json({"register", file("bracket-scan.csv"), file("bracket.stl"), "-o", "out"}, ExitCode::done);
  EXPECT_EQ(found.at("status"), "ok");
  const RigidTransform pose = read_transform(folder.path() / "out" / "transform.csv");
  const RigidTransform off = pose * part_from_bracket_scan().inverse();
  const auto& uncertainty = found.at("standard_uncertainty");
  Eigen::Vector3d reference;
  for (int k = 0; k < 3; ++k) reference[k] = uncertainty.at("reference_mm").at(static_cast<std::size_t>(k));
  const Eigen::Vector3d shift = off * reference - reference;
  for (int k = 0; k < 3; ++k) {
    const double u = uncertainty.at("shift_mm").at(static_cast<std::size_t>(k));
    EXPECT_LT(u, 0.001);
    EXPECT_LT(std::abs(shift[k]), 4 * u) << k;
  }
  const PlyContents placed = parse_ply(folder.read("out/registered.ply"), "registered.ply");
  EXPECT_EQ(placed.points.cols(), 2000);
  EXPECT_EQ(nlohmann::json::parse(folder.read("out/registration.json")), found);
  EXPECT_THAT(folder.read("out/report.html"), HasSubstr("Registration of bracket-scan.csv on bracket.stl"));
}

TEST_F(Scan, EveryLossAndStartFindsTheSamePose) {
  const std::vector<std::string> base{"register", file("bracket-scan.csv"), file("bracket.stl")};
  for (const char* loss : {"welsch", "tukey", "adf"}) {
    std::vector<std::string> arguments = base;
    arguments.insert(arguments.end(), {"--loss", loss, "--start", file("bracket-transform.csv"), "-o", loss});
    json(arguments, ExitCode::done);
    const RigidTransform off =
        read_transform(folder.path() / loss / "transform.csv") * part_from_bracket_scan().inverse();
    EXPECT_LT((off * Eigen::Vector3d(25, 15, 12) - Eigen::Vector3d(25, 15, 12)).norm(), 0.002) << loss;
  }
}

TEST_F(Scan, APinThatTurnsAboutItsAxisIsSaidAndAnsweredNo) {
  const CommandResult result = abbe({"register", file("pin-scan.csv"), file("pin.stl")});
  EXPECT_EQ(result.exit_code, ExitCode::computation_says_no);
  EXPECT_THAT(result.out, HasSubstr("undetermined: motions of the scan along the surface change nothing"));
  EXPECT_THAT(result.out, HasSubstr("turn about the line along ("));
  EXPECT_EQ(result.err, "");
}

TEST_F(Scan, DeviationsOfTheBracketShowTheStepThatIsTooHigh) {
  const auto found =
      json({"deviate", file("bracket-scan.csv"), file("bracket.stl"), "--transform", file("bracket-transform.csv"),
            "--largest-mm", "0.3", "--faces-deg", "30", "--lower-um", "-20", "--upper-um", "20", "-o", "out"},
           ExitCode::done);
  const auto& figures = found.at("figures");
  EXPECT_NEAR(figures.at("median").at("value_um"), 0, 2);
  EXPECT_GT(figures.at("rms").at("value_um"), figures.at("rms_about_mean").at("value_um"));
  int steps = 0;
  for (const auto& face : found.at("faces")) {
    if (face.at("points").get<int>() < 50) continue;
    const bool high = std::abs(face.at("middle_mm").at(1).get<double>() - 17) < 1e-6;
    steps += high ? 1 : 0;
    EXPECT_NEAR(face.at("mean_um"), high ? 100 : 0, 3) << face;
  }
  EXPECT_EQ(steps, 1);
  const std::size_t counted = found.at("points_counted");
  EXPECT_GT(counted, 1750u);
  EXPECT_LT(counted, 1900u);
  EXPECT_EQ(parse_ply(folder.read("out/deviation.ply"), "deviation.ply").points.cols(),
            static_cast<Eigen::Index>(counted));
  EXPECT_THAT(folder.read("out/deviation.csv"), HasSubstr("x_mm,y_mm,z_mm,deviation_mm\n"));
  EXPECT_THAT(folder.read("out/report.html"), HasSubstr("Deviation of bracket-scan.csv from bracket.stl"));
}

TEST_F(Scan, GroupsOfAnObjFileAreFacesOfTheDeviation) {
  folder.write(
      "steps.obj",
      "o part\nv 0 0 0\nv 10 0 0\nv 10 10 0\nv 0 10 0\ng left\nf 1 2 3 4\nv 10 0 5\nv 20 0 5\nv 20 10 5\nv 10 10 5\n"
      "g right\nf 5 6 7 8\n");
  folder.write("scan.csv", "x_mm,y_mm,z_mm\n2,2,0.01\n3,4,0.03\n15,5,4.99\n16,3,4.97\n");
  const auto found = json({"deviate", "scan.csv", "steps.obj", "--faces"}, ExitCode::done);
  ASSERT_EQ(found.at("faces").size(), 2u);
  EXPECT_EQ(found.at("faces").at(0).at("name"), "part / left");
  EXPECT_NEAR(found.at("faces").at(0).at("mean_um"), 20, 1e-9);
  EXPECT_EQ(found.at("faces").at(1).at("name"), "part / right");
  EXPECT_NEAR(found.at("faces").at(1).at("mean_um"), -20, 1e-9);
  EXPECT_NEAR(found.at("faces").at(1).at("area_mm2"), 100, 1e-9);
  const CommandResult none = abbe({"deviate", file("pin-scan.csv"), file("pin.stl"), "--faces"});
  EXPECT_EQ(none.exit_code, ExitCode::bad_input);
  EXPECT_THAT(none.err, HasSubstr("pin.stl: the file states no faces"));
  EXPECT_THAT(abbe({"check", "steps.obj"}).out, HasSubstr("groups                 2"));
}

TEST_F(Scan, WithoutAPoseThereIsNoTransform) {
  folder.write("few.csv", "x_mm,y_mm,z_mm\n1,2,3\n4,5,6\n7,1,2\n");
  // What an earlier registration left there goes as well.
  json({"register", file("pin-scan.csv"), file("pin.stl"), "-o", "out"}, ExitCode::computation_says_no);
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "out/transform.csv"));
  const CommandResult none = abbe({"register", "few.csv", file("pin.stl"), "-o", "out"});
  EXPECT_EQ(none.exit_code, ExitCode::computation_says_no);
  EXPECT_THAT(none.out, HasSubstr("too few points for a pose"));
  EXPECT_THAT(none.out, HasSubstr("results in out, without transform.csv and registered.ply"));
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "out/registration.json"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "out/transform.csv"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "out/registered.ply"));
}

TEST_F(Scan, DeviateLooksAtWhatTheRegistrationSaid) {
  json({"register", file("pin-scan.csv"), file("pin.stl"), "-o", "out"}, ExitCode::computation_says_no);
  EXPECT_THAT(folder.read("out/transform.csv"), testing::StartsWith("# status: undetermined\n"));
  const std::vector<std::string> deviate{"deviate", file("pin-scan.csv"), file("pin.stl"), "--transform"};
  std::vector<std::string> arguments = deviate;
  arguments.emplace_back("out/transform.csv");
  const CommandResult turned = abbe(arguments);
  EXPECT_EQ(turned.exit_code, ExitCode::done) << turned.err;
  EXPECT_THAT(turned.out, HasSubstr("out/transform.csv says undetermined"));
  folder.write("lost.csv",
               "# status: not_converged\nrotation_x,rotation_y,rotation_z,translation_mm\n1,0,0,0\n0,1,0,0\n0,0,1,0\n");
  arguments.back() = "lost.csv";
  const CommandResult lost = abbe(arguments);
  EXPECT_EQ(lost.exit_code, ExitCode::bad_input);
  EXPECT_THAT(lost.err, HasSubstr("lost.csv"));
  EXPECT_THAT(lost.err, HasSubstr("says not_converged; expected the transform of a registration that found a pose"));
}

TEST_F(Scan, DeviationsOfAScanElsewhereAreAnsweredNo) {
  folder.write("far.csv", "x_mm,y_mm,z_mm\n300,0,0\n301,0,0\n300,1,0\n");
  const CommandResult far = abbe({"deviate", "far.csv", file("bracket.stl"), "-o", "out"});
  EXPECT_EQ(far.exit_code, ExitCode::computation_says_no);
  EXPECT_THAT(far.out, HasSubstr("The scan is not where the part is: half of its points are farther than"));
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "out/evaluation.json"));
}

TEST_F(Scan, ATolerancePassedIsAnsweredNo) {
  const auto found = json({"deviate", file("pin-scan.csv"), file("pin.stl"), "--transform", file("pin-transform.csv"),
                           "--tolerance", "maximum_um=5"},
                          ExitCode::computation_says_no);
  EXPECT_GT(found.at("figures").at("maximum").at("value_um"), 5);
}

TEST_F(Scan, BadInputIsNamed) {
  folder.write("empty.csv", "x_mm,y_mm,z_mm\n");
  folder.write("transform.csv", "rotation_x,rotation_y,rotation_z,translation_mm\n1,0,0,0\n0,2,0,0\n0,0,1,0\n");
  const CommandResult empty = abbe({"register", "empty.csv", file("pin.stl")});
  EXPECT_EQ(empty.exit_code, ExitCode::bad_input);
  EXPECT_THAT(empty.err, HasSubstr("empty.csv"));
  const CommandResult matrix = abbe({"deviate", file("pin-scan.csv"), file("pin.stl"), "--transform", "transform.csv"});
  EXPECT_EQ(matrix.exit_code, ExitCode::bad_input);
  EXPECT_THAT(matrix.err, HasSubstr("not a rotation matrix"));
  const CommandResult start = abbe({"register", file("pin-scan.csv"), file("pin.stl"), "--start", "nowhere.csv"});
  EXPECT_EQ(start.exit_code, ExitCode::bad_input);
  EXPECT_THAT(start.err, HasSubstr("nowhere.csv"));
  const CommandResult loss = abbe({"register", file("pin-scan.csv"), file("pin.stl"), "--loss", "huber"});
  EXPECT_EQ(loss.exit_code, ExitCode::bad_input);
}

}  // namespace
}  // namespace abbe
