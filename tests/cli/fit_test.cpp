#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/command_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;

/// `abbe fit`: its figures are those its examples were made with; what it refuses and what it cannot answer.
class Fit : public CommandTest {
 protected:
  nlohmann::json json(std::vector<std::string> arguments, int expected_exit = ExitCode::done) const {
    arguments.insert(arguments.begin(), "fit");
    arguments.emplace_back("--json");
    const CommandResult result = abbe(arguments);
    EXPECT_EQ(result.exit_code, expected_exit) << result.err;
    return nlohmann::json::parse(result.out, nullptr, false);
  }
  void expect_refused(std::vector<std::string> arguments, const std::string& message) const {
    arguments.insert(arguments.begin(), "fit");
    const CommandResult result = abbe(arguments);
    EXPECT_EQ(result.exit_code, ExitCode::bad_input);
    EXPECT_EQ(result.out, "");
    EXPECT_THAT(result.err, HasSubstr(message));
  }
  /// Within the stated expanded uncertainty and a half more.
  static void expect_covers(const nlohmann::json& figure, double truth, const std::string& unit = "_mm") {
    const double value = figure.at("value" + unit), uncertainty = figure.at("expanded_uncertainty" + unit);
    EXPECT_NEAR(value, truth, 1.5 * uncertainty) << figure;
  }
  const std::string examples = std::string(ABBE_SOURCE_DIR "/examples/fit/");
};

TEST_F(Fit, CylinderOfTheBoreByAllMethods) {
  const auto least = json({examples + "bore.csv", "--shape", "cylinder"});
  const auto zone = json({examples + "bore.csv", "--shape", "cylinder", "--method", "minimum-zone"});
  const auto within = json({examples + "bore.csv", "--shape", "cylinder", "--method", "inscribed"});
  const auto around = json({examples + "bore.csv", "--shape", "cylinder", "--method", "circumscribed"});
  const auto form = [](const nlohmann::json& j) { return j.at("figures").at("form").at("value_um").get<double>(); };
  const auto radius = [](const nlohmann::json& j) { return j.at("figures").at("radius").at("value_mm").get<double>(); };
  EXPECT_NEAR(radius(least), 15.0016, 0.001);
  EXPECT_NEAR(least.at("figures").at("direction_x").at("value").get<double>(), 0.02, 2e-4);
  EXPECT_LT(form(zone), form(least));
  EXPECT_LT(radius(within), radius(least));
  EXPECT_GT(radius(around), radius(least));
  EXPECT_EQ(zone.at("touching").size(), 6U);
  EXPECT_NEAR(std::abs(zone.at("touching")[0].at("deviation_um").get<double>()), form(zone) / 2, 1e-6);
  EXPECT_FALSE(zone.at("figures").at("radius").contains("expanded_uncertainty_mm"));
  const auto stated =
      json({examples + "bore.csv", "--shape", "cylinder", "--method", "minimum-zone", "--u-point-um", "0.5"});
  EXPECT_GT(stated.at("figures").at("radius").at("expanded_uncertainty_mm").get<double>(), 1e-5);
}

TEST_F(Fit, RobustSphereAmongWrongPointsAndItsHeldRadius) {
  const auto free = json({examples + "scanned-ball.xyz", "--shape", "sphere", "--method", "robust"}).at("figures");
  expect_covers(free.at("x"), 5);
  expect_covers(free.at("y"), 8);
  expect_covers(free.at("z"), 40);
  expect_covers(free.at("radius"), 12.7);
  const auto held =
      json({examples + "scanned-ball.xyz", "--shape", "sphere", "--method", "robust", "--fixed-radius-mm", "12.7"});
  EXPECT_EQ(held.at("figures").at("radius").at("value_mm"), 12.7);
  EXPECT_FALSE(held.at("figures").at("radius").contains("expanded_uncertainty_mm"));
  expect_covers(held.at("figures").at("z"), 40);
  EXPECT_GT(held.at("rejected").get<int>(), 60);
}

TEST_F(Fit, CoaxialCirclesShareTheirAxis) {
  const auto result = json({examples + "step-1.csv", examples + "step-2.csv", "--shape", "coaxial-circles"});
  const auto& figures = result.at("figures");
  expect_covers(figures.at("radius_1"), 18);
  expect_covers(figures.at("radius_2"), 9);
  const double length = std::sqrt(1 + 0.03 * 0.03 + 0.02 * 0.02);
  expect_covers(figures.at("direction_y"), 0.03 / length, "");
  expect_covers(figures.at("direction_z"), -0.02 / length, "");
  EXPECT_NEAR(figures.at("height_2").at("value_mm").get<double>() - figures.at("height_1").at("value_mm").get<double>(),
              75, 0.002);
}

TEST_F(Fit, WritesResidualsAndTheResultsFolder) {
  const auto result = json(
      {examples + "ring.csv", "--shape", "circle2", "--residuals", "r.csv", "-o", "out", "--tolerance", "form_um=20"});
  EXPECT_EQ(result.at("within_tolerance"), true);
  EXPECT_EQ(result.at("figures").at("form").at("verdict"), "within");
  const std::string csv = folder.read("r.csv");
  EXPECT_EQ(csv.substr(0, csv.find('\n')), "x_mm,y_mm,z_mm,deviation_mm");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 181);
  EXPECT_THAT(folder.read("out/plot.svg"), HasSubstr("</svg>"));
  EXPECT_THAT(folder.read("out/report.html"), HasSubstr("roundness"));
  EXPECT_EQ(nlohmann::json::parse(folder.read("out/evaluation.json")), result);
  // What it writes it reads: the residuals are points again.
  EXPECT_EQ(json({"r.csv", "--shape", "circle2"}).at("radius_mm"), result.at("radius_mm"));
  json({examples + "ring.csv", "--shape", "circle2", "--tolerance", "form_um=1"}, ExitCode::computation_says_no);
}

TEST_F(Fit, SaysWhenThereIsNoAnswerAndWritesNoNumber) {
  folder.write("line.xyz", "0 0 0\n1 1 1\n2 2 2\n3 3 3\n4 4 4\n5 5 5\n");
  for (const std::string shape : {"plane", "circle", "sphere", "cylinder", "cone"}) {
    const auto result = json({"line.xyz", "--shape", shape, "--residuals", "none.csv"}, ExitCode::computation_says_no);
    EXPECT_EQ(result.at("status"), "degenerate points") << shape;
    EXPECT_EQ(result.at("figures").at("form").at("not_evaluated"), "degenerate points");
    EXPECT_FALSE(result.contains("point_mm"));
  }
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "none.csv"));
  const CommandResult people = abbe({"fit", "line.xyz", "--shape", "plane"});
  EXPECT_EQ(people.exit_code, ExitCode::computation_says_no);
  EXPECT_THAT(people.out, HasSubstr("all points are on one straight line"));
  EXPECT_EQ(json({"line.xyz", "--shape", "line"}).at("status"), "ok");
}

TEST_F(Fit, UnitsCornersOfMeshesAndPlanarShapes) {
  folder.write("inch.xyz", "1 0 7\n0 1 7\n-1 0 8\n0 -1 7\n");
  const auto ring = json({"inch.xyz", "--shape", "circle2", "--unit", "inch"});
  EXPECT_NEAR(ring.at("radius_mm").get<double>(), 25.4, 1e-12);
  EXPECT_THAT(ring.at("notes").dump(), HasSubstr("z, from 177.8 to 203.2 mm, was left out"));
  folder.write("flat.csv", "x_mm,y_mm\n0,1\n10,3\n20,5\n30,7\n");
  EXPECT_NEAR(json({"flat.csv", "--shape", "line2"}).at("figures").at("direction_y").at("value").get<double>(),
              1 / std::sqrt(26), 1e-9);
  EXPECT_THAT(abbe({"fit", "flat.csv", "--shape", "line"}).err, HasSubstr("flat.csv:1: z: missing column"));
  folder.write(
      "t.stl",
      "solid t\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 4 0 0\nvertex 0 4 0\nendloop\nendfacet\n"
      "facet normal 0 0 1\nouter loop\nvertex 4 0 0\nvertex 4 4 0\nvertex 0 4 0\nendloop\nendfacet\nendsolid\n");
  const auto plane = json({"t.stl", "--shape", "plane", "--u-point-um", "1"});
  EXPECT_EQ(plane.at("points"), 4);
  expect_covers(plane.at("figures").at("z"), 0);
}

TEST_F(Fit, RefusesWhatMeansNothing) {
  const std::string ring = examples + "ring.csv";
  expect_refused({ring, "--shape", "plane", "--fixed-radius-mm", "3"},
                 "--fixed-radius-mm: there is no radius of plane to hold");
  expect_refused({ring, "--shape", "circle", "--fixed-radius-mm", "-3"}, "a number of mm above zero");
  expect_refused({ring, "--shape", "plane", "--fixed-direction", "0,0"}, "three numbers, not all zero");
  expect_refused({ring, "--shape", "plane", "--fixed-direction", "0,a,1"}, "'a' is not a number");
  expect_refused({ring, "--shape", "sphere", "--fixed-direction", "0,0,1"}, "there is no direction of sphere");
  expect_refused({ring, "--shape", "plane", "--method", "inscribed"}, "circle2, sphere or cylinder");
  expect_refused({ring, "--shape", "square"}, "square");
  expect_refused({ring, ring, "--shape", "plane"}, "there are 2 files");
  expect_refused({"missing.csv", "--shape", "plane"}, "missing.csv");
  expect_refused({ring, "--shape", "circle2", "--u-point-um", "-1"}, "--u-point-um");
  expect_refused({ring, "--shape", "circle2", "--tolerance", "form=1"}, "the unit is missing");
}

}  // namespace
}  // namespace abbe
