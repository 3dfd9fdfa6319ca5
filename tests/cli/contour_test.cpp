// `abbe evaluate contour`: sections of a line scanner, and points against a commanded curve.
#include <cmath>
#include <numbers>

#include "cli/evaluate_for_test.h"

namespace abbe {
namespace {

class ContourTest : public EvaluateTest {
 protected:
  const std::string engraver = std::string(ABBE_SOURCE_DIR) + "/examples/laser_engraver/";

  /// Points of an edge whose corner is there, in um: surface, rounding of radius 20 um, wall.
  static void add_section(std::string& csv, const std::string& name, double along, double corner) {
    const double r = 20;
    const auto add = [&](double u, double v) {
      csv += name + "," + std::to_string(along) + "," + std::to_string(u) + "," + std::to_string(v) + "\n";
    };
    for (int i = 0; i < 60; ++i) add(corner - r - 120 + 2 * i, 0);
    for (int i = 0; i < 40; ++i) {
      const double a = (i + 0.5) * std::numbers::pi / 80;
      add(corner - r + r * std::sin(a), r * std::cos(a) - r);
    }
    for (int i = 0; i < 30; ++i) add(corner, -r - 2 * i);
  }
  const std::string header = "section,along_mm,across_um,height_um\n";
};

TEST_F(ContourTest, GivesTheDistanceOfTheEdgeFromItsCommandAndTheRoundingApart) {
  std::string csv = header;
  add_section(csv, "A", 0, 5);
  add_section(csv, "B", 4, -25);
  add_section(csv, "C", 8, 15);
  const std::string file = folder.write("sections.csv", csv);
  const nlohmann::json result =
      json({"contour", file, "--tolerance", "contour_max_um=30", "-o", (folder.path() / "out").string()});
  const nlohmann::json& figures = result["figures"];
  EXPECT_NEAR(figures["contour_mean"]["value_um"].get<double>(), 15, 1e-4);
  EXPECT_NEAR(figures["contour_max"]["value_um"].get<double>(), 25, 1e-4);
  EXPECT_NEAR(figures["contour_s"]["value_um"].get<double>(), 10, 1e-4);
  EXPECT_NEAR(figures["bias"]["value_um"].get<double>(), -5.0 / 3, 1e-4);
  EXPECT_NEAR(figures["rounding_mean"]["value_um"].get<double>(), 20, 1e-4);
  EXPECT_NEAR(figures["rounding_s"]["value_um"].get<double>(), 0, 1e-4);
  EXPECT_EQ(figures["contour_max"]["verdict"], "within");
  ASSERT_EQ(result["sections"].size(), 3U);
  EXPECT_NEAR(result["sections"][1]["P1_mm"][0].get<double>(), -0.045, 1e-6);
  EXPECT_NEAR(result["sections"][1]["P2_mm"][0].get<double>(), -0.025, 1e-6);
  for (const char* name : {"evaluation.json", "plot.svg", "section.svg", "report.html"}) {
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "out" / name)) << name;
  }
  json({"contour", file, "--tolerance", "contour_max_um=20"}, computation_says_no);
}

TEST_F(ContourTest, ASectionWithoutACornerIsNamedAndMakesTheAnswerNo) {
  std::string csv = header;
  add_section(csv, "A", 0, 5);
  for (int i = 0; i < 40; ++i) csv += "flat,4," + std::to_string(3 * i) + ",0\n";
  const nlohmann::json result = json({"contour", folder.write("sections.csv", csv)}, computation_says_no);
  EXPECT_EQ(result["facts"]["sections"], "1 of 2 evaluated");
  EXPECT_NE(result["sections"][1]["not_evaluated"].get<std::string>().find("deeper"), std::string::npos);
  EXPECT_NEAR(result["figures"]["contour_max"]["value_um"].get<double>(), 5, 1e-4);
}

TEST_F(ContourTest, TheExampleIsThatOfASimulatedPart) {
  const nlohmann::json sections =
      json({"contour", engraver + "sections.csv", "--u-height-um", "2", "--u-across-um", "1", "--u-origin-um", "2"});
  const nlohmann::json& figures = sections["figures"];
  EXPECT_GT(figures["contour_mean"]["value_um"].get<double>(), 2);
  EXPECT_LT(figures["contour_max"]["value_um"].get<double>(), 60);
  EXPECT_NEAR(figures["rounding_mean"]["value_um"].get<double>(), 15, 4);
  EXPECT_GT(figures["contour_mean"]["expanded_uncertainty_um"].get<double>(), 0.3);
  const nlohmann::json points = json({"contour", engraver + "engraved.csv", "--curve", engraver + "table-a4.csv"});
  EXPECT_EQ(points["points"].size(), 30U);
  EXPECT_LT(points["figures"]["contour_max"]["value_um"].get<double>(), 60);
  EXPECT_LT(points["figures"]["height_max"]["value_um"].get<double>(), 1.2);  // as exact as the cylinder is round
}

TEST_F(ContourTest, WhatIsWrongIsSaid) {
  const std::string file = folder.write("sections.csv", header);
  EXPECT_EQ(abbe({"evaluate", "contour", file}).exit_code, bad_input);
  std::string csv = header;
  add_section(csv, "A", 0, 5);
  const std::string good = folder.write("good.csv", csv);
  EXPECT_EQ(abbe({"evaluate", "contour", good, "--closed"}).exit_code, bad_input);
  EXPECT_EQ(abbe({"evaluate", "contour", good, "--curve", engraver + "table-a4.csv"}).exit_code, bad_input);
  EXPECT_EQ(abbe({"evaluate", "contour", good, "--surface", "up"}).exit_code, bad_input);
}

}  // namespace
}  // namespace abbe
