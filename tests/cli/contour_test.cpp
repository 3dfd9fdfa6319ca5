// `abbe evaluate contour`: sections of a line scanner, and points against a commanded curve.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numbers>

#include "cli/evaluate_for_test.h"

namespace abbe {
namespace {

class ContourTest : public EvaluateTest {
 protected:
  const std::string engraver = std::string(ABBE_SOURCE_DIR "/examples/laser_engraver/");

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
  /// What the page in a results folder shows.
  nlohmann::json page_data(const std::string& output) const {
    std::ifstream file(folder.path() / output / "report.html");
    const std::string page(std::istreambuf_iterator<char>(file), {}), begin = "id=\"abbe-data\">";
    const std::size_t from = page.find(begin) + begin.size();
    return nlohmann::json::parse(page.substr(from, page.find("</script>", from) - from), nullptr, false);
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

TEST_F(ContourTest, ThePageHoldsTheContourErrorAlongTheCurveAndTheSections) {
  std::string csv = header;
  add_section(csv, "B", 4, -25);
  add_section(csv, "A", 0, 5);
  for (int i = 0; i < 40; ++i) csv += "flat,8," + std::to_string(3 * i) + ",0\n";
  const std::string file = folder.write("sections.csv", csv);
  const nlohmann::json found = json({"contour", file, "--u-origin-um", "3", "--u-across-um", "1", "--u-height-um", "1",
                                     "--tolerance", "contour_max_um=30", "-o", (folder.path() / "out").string()},
                                    computation_says_no);
  const nlohmann::json data = page_data("out");
  const nlohmann::json& contour = data["contour"];
  // In the order of the curve, as the figures have it; uncertainties with that of the origins.
  EXPECT_EQ(contour["s_mm"], nlohmann::json({0.0, 4.0}));
  for (const std::size_t i : {0U, 1U}) {
    const nlohmann::json& section = found["sections"][1 - i];
    EXPECT_EQ(contour["error_um"][i], section["contour_error_um"]);
    EXPECT_NEAR(contour["u_um"][i].get<double>(), std::hypot(section["u_contour_error_um"].get<double>(), 3), 1e-9);
    EXPECT_EQ(contour["also"][0]["value_um"][i], section["P1_P2_um"]);
  }
  EXPECT_EQ(contour["limits_um"], nlohmann::json({-30.0, 30.0}));
  ASSERT_EQ(contour["sections"].size(), 3U);
  const nlohmann::json& first = contour["sections"][0];
  EXPECT_EQ(first["name"], "B");
  for (const char* const end : {"P1", "P2"}) {
    const double u = found["sections"][0][std::string(end) + "_mm"][0].get<double>();
    EXPECT_NEAR(first["edges"][0][std::string(end) + "_um"][0].get<double>(), 1e3 * u, 0.006) << end;
    EXPECT_LT(u, -0.02);
  }
  EXPECT_GT(first["across_um"].size(), 80U);
  EXPECT_EQ(first["across_um"].size(), first["height_um"].size());
  EXPECT_EQ(contour["sections"][2]["not_evaluated"], found["sections"][2]["not_evaluated"]);
  EXPECT_EQ(contour["sections"][2]["across_um"].size(), 40U);
  // The page draws them itself: no second drawing of the same.
  EXPECT_EQ(data["evaluation"].count("drawings"), 0U);
}

TEST_F(ContourTest, ThePageOfManyPointsAndSectionsIsThinnedAndKeepsItsPeaks) {
  std::string points = "x_mm,y_mm,z_mm\n";
  for (int i = 0; i < 5000; ++i) {
    points += std::to_string(0.002 * (4999 - i)) + "," +
              (i == 1234    ? "0.05"
               : i % 2 == 0 ? "0.01"
                            : "-0.002") +
              ",0.001\n";
  }
  const std::string curve = folder.write("line.csv", "x_mm,y_mm,z_mm,i,j,k\n0,0,0,0,0,1\n10,0,0,0,0,1\n");
  json({"contour", folder.write("points.csv", points), "--curve", curve, "-o", (folder.path() / "points").string()});
  const nlohmann::json line = page_data("points")["contour"];
  EXPECT_LE(line["error_um"].size(), 2000U);
  EXPECT_EQ(line["points"], 5000);
  EXPECT_TRUE(std::is_sorted(line["s_mm"].begin(), line["s_mm"].end()));
  EXPECT_NEAR(line["largest_um"].get<double>(), 50, 1e-9);
  // The mean is that of the amounts, as papers state it; with signs it has a name of its own.
  EXPECT_NEAR(line["mean_um"].get<double>(), (2499 * 10.0 + 2500 * 2.0 + 50) / 5000, 1e-9);
  EXPECT_NEAR(line["bias_um"].get<double>(), (2499 * 10.0 - 2500 * 2.0 + 50) / 5000, 1e-9);
  EXPECT_EQ(std::count_if(line["error_um"].begin(), line["error_um"].end(), [](double e) { return e > 49; }), 1);
  EXPECT_NEAR(line["also"][0]["value_um"][0].get<double>(), 1, 1e-9);
  std::string csv = "section,across_um,height_um\n";
  for (int s = 0; s < 150; ++s) {
    for (int i = 0; i < 30; ++i) csv += "s" + std::to_string(s) + "," + std::to_string(3 * i) + ",0\n";
  }
  json({"contour", folder.write("flat.csv", csv), "-o", (folder.path() / "flat").string()}, computation_says_no);
  const nlohmann::json flat = page_data("flat")["contour"];
  EXPECT_EQ(flat["sections_in_all"], 150);
  EXPECT_LE(flat["sections"].size(), 80U);
  EXPECT_GE(flat["sections"].size(), 50U);
  EXPECT_EQ(flat["counted"], "section");
  EXPECT_TRUE(flat["error_um"].empty());
}

TEST_F(ContourTest, AGrooveShowsBothOfItsEdges) {
  // Edges with roundings of 20 and 8 um at -50 and 60 um: the middle is 5 um off.
  std::string csv = "section,across_um,height_um\n";
  const auto add = [&](double u, double v) { csv += "A," + std::to_string(u) + "," + std::to_string(v) + "\n"; };
  const auto edge = [&](double corner, double r, double side, bool down) {
    for (int n = 0; n < 130; ++n) {
      const int k = down ? n : 129 - n;
      if (k < 60) add(corner - side * (r + 120 - 2 * k), 0);
      const double a = (k - 60 + 0.5) * std::numbers::pi / 80;
      if (k >= 60 && k < 100) add(corner - side * (r - r * std::sin(a)), r * std::cos(a) - r);
      if (k >= 100) add(corner, -r - 2 * (k - 100));
    }
  };
  edge(-50, 20, 1, true);
  for (int i = 0; i < 20; ++i) add(-40 + 4 * i, -79);
  edge(60, 8, -1, false);
  const std::string out = (folder.path() / "out").string();
  const nlohmann::json found = json({"contour", folder.write("groove.csv", csv), "--feature", "groove", "-o", out});
  EXPECT_NEAR(found["figures"]["contour_max"]["value_um"].get<double>(), 5, 0.05);
  EXPECT_NEAR(found["sections"][0]["width_um"].get<double>(), 110, 0.1);
  EXPECT_NEAR(found["sections"][0]["left"]["radius_um"].get<double>(), 20, 0.1);
  EXPECT_NEAR(found["sections"][0]["right"]["radius_um"].get<double>(), 8, 0.1);
  std::ifstream file(folder.path() / "out" / "report.html");
  const std::string page(std::istreambuf_iterator<char>(file), {});
  for (const char* const words :
       {"radius in \xC2\xB5m, left edge", "radius in \xC2\xB5m, right edge", "20.00", "8.00"}) {
    EXPECT_NE(page.find(words), std::string::npos) << words;
  }
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

TEST_F(ContourTest, AProgramIsReadWithItsMachineAndComparedWhereTheToolWorks) {
  // Two regions, C2 turned between them: the way to the first point of the second is no part of the curve.
  const std::string program = engraver + "regions.ngc";
  const std::string machine = std::string(ABBE_SOURCE_DIR "/examples/machines/yin-engraver-u.machine.toml");
  const nlohmann::json found = json({"contour", engraver + "engraved.csv", "--curve", program, "--machine", machine});
  EXPECT_NE(found["facts"]["commanded curve"].get<std::string>().find("in 2 pieces"), std::string::npos);
  EXPECT_LT(found["figures"]["contour_max"]["value_um"].get<double>(), 60);
  const CommandResult without = abbe({"evaluate", "contour", engraver + "engraved.csv", "--curve", program});
  EXPECT_EQ(without.exit_code, bad_input);
  EXPECT_NE(without.err.find("regions.ngc:3: C2=0"), std::string::npos) << without.err;
  EXPECT_NE(without.err.find("--machine"), std::string::npos) << without.err;
  // The same of a column.
  const std::string column = folder.write("column.csv", "x_mm,y_mm,z_mm,i,j,k,C2_deg\n0,0,0,0,0,1,0\n9,0,0,0,0,1,0\n");
  const CommandResult bare = abbe({"evaluate", "contour", engraver + "engraved.csv", "--curve", column});
  EXPECT_NE(bare.err.find("C2_deg"), std::string::npos) << bare.err;
  EXPECT_NE(bare.err.find("--machine"), std::string::npos) << bare.err;
}

TEST_F(ContourTest, RapidMovesAreNoPartOfTheCurve) {
  // Two lines of 10 mm, 5 mm apart; a point half way between their ends lies 2.4 mm beside the second one. On the
  // rapid move between them it would lie on the curve.
  const std::string curve = folder.write("two.ngc",
                                         "G21 G90\nF600\nG0 X0 Y0 Z0 I0 J0 K1\nM3\nG1 X10\nM5\nG0 X10 Y5\nM3\nG1 X0\n"
                                         "M5\nG0 X0 Y50\nM30\n");
  const std::string points = folder.write("points.csv", "x_mm,y_mm,z_mm\n2,0.01,0\n10,2.6,0\n8,4.98,0\n3,20,0\n");
  const nlohmann::json found = json({"contour", points, "--curve", curve});
  ASSERT_EQ(found["points"].size(), 4U);
  EXPECT_NEAR(found["points"][0]["across_um"].get<double>(), 10, 1e-6);
  EXPECT_NEAR(found["points"][1]["distance_um"].get<double>(), 2400, 1e-6);
  EXPECT_NEAR(found["points"][2]["across_um"].get<double>(), 20, 1e-6);  // to the left, as it goes back
  EXPECT_NEAR(found["points"][2]["along_mm"].get<double>(), 12, 1e-9);
  EXPECT_NEAR(found["points"][3]["distance_um"].get<double>(), 15000, 1e-6);
  // The same by the column `beam`.
  const std::string csv = folder.write("two.csv",
                                       "x_mm,y_mm,z_mm,i,j,k,beam\n0,0,0,0,0,1,1\n10,0,0,0,0,1,1\n10,5,0,0,0,1,0\n"
                                       "0,5,0,0,0,1,1\n0,50,0,0,0,1,0\n");
  EXPECT_EQ(json({"contour", points, "--curve", csv})["points"], found["points"]);
  const std::string idle = folder.write("idle.ngc", "G0 X0 Y0 Z0 I0 J0 K1\nG0 X10\n");
  const CommandResult nothing = abbe({"evaluate", "contour", points, "--curve", idle});
  EXPECT_EQ(nothing.exit_code, bad_input);
  EXPECT_NE(nothing.err.find("does not cut on the way to any of its points"), std::string::npos) << nothing.err;
}

TEST_F(ContourTest, ACurveThatComesBackIsClosed) {
  std::string curve = "x_mm,y_mm,z_mm,i,j,k\n", points = "x_mm,y_mm,z_mm\n";
  const auto place = [](double radius, double turn) {
    return std::to_string(radius * std::cos(turn)) + "," + std::to_string(radius * std::sin(turn)) + ",0";
  };
  for (int i = 0; i < 40; ++i) {
    curve += place(20, std::numbers::pi * i / 20) + ",0,0,1\n";
    points += place(20.03, std::numbers::pi * (i + 0.5) / 20) + "\n";
  }
  const std::string measured = folder.write("points.csv", points);
  const nlohmann::json closed = json({"contour", measured, "--curve", folder.write("ring.csv", curve), "--closed"});
  const nlohmann::json back =
      json({"contour", measured, "--curve", folder.write("back.csv", curve + place(20, 0) + ",0,0,1\n")});
  for (const nlohmann::json& found : {closed, back}) {
    EXPECT_NE(found["facts"]["commanded curve"].get<std::string>().find("40 points, 125.66"), std::string::npos);
    EXPECT_NEAR(found["figures"]["contour_max"]["value_um"].get<double>(), 30, 2);
    EXPECT_NEAR(found["figures"]["contour_mean"]["value_um"].get<double>(), 30, 1);
  }
}

TEST_F(ContourTest, WhatIsWrongIsSaid) {
  const auto refused = [&](std::vector<std::string> words, const std::string& what) {
    words.insert(words.begin(), {"evaluate", "contour"});
    const CommandResult result = abbe(words);
    EXPECT_EQ(result.exit_code, bad_input);
    EXPECT_NE(result.err.find(what), std::string::npos) << result.err << "does not say: " << what;
  };
  refused({folder.write("sections.csv", header)}, "no rows");
  std::string csv = header;
  add_section(csv, "A", 0, 5);
  const std::string good = folder.write("good.csv", csv);
  refused({good, "--curve", engraver + "table-a4.csv"}, "good.csv");
  refused({good, "--surface", "up"}, "--surface");
}

TEST_F(ContourTest, OptionsWithoutEffectAreRefused) {
  const std::string points = engraver + "engraved.csv", curve = engraver + "table-a4.csv";
  const auto refused = [&](const std::string& file, const std::vector<std::string>& options, const std::string& what) {
    std::vector<std::string> words = {"evaluate", "contour", file};
    words.insert(words.end(), options.begin(), options.end());
    const CommandResult result = abbe(words);
    EXPECT_EQ(result.exit_code, bad_input) << options.back();
    EXPECT_NE(result.err.find(what), std::string::npos) << result.err << "does not say: " << what;
  };
  const std::vector<std::vector<std::string>> of_sections = {
      {"--feature", "groove"},       {"--surface", "left"},  {"--beam-tilt-deg", "1"}, {"--free-wall"},
      {"--surface-radius-mm", "50"}, {"--u-across-um", "1"}, {"--u-height-um", "1"}};
  for (std::vector<std::string> options : of_sections) {
    const std::string name = options[0];
    options.insert(options.end(), {"--curve", curve});
    refused(points, options, name + ": has no effect");
  }
  std::string csv = "section,across_um,height_um,beam_tilt_deg\n";
  for (int i = 0; i < 40; ++i) csv += "A," + std::to_string(i) + "," + std::to_string(i > 20 ? -50 : 0) + ",0.5\n";
  const std::string tilted = folder.write("tilted.csv", csv);
  refused(tilted, {"--closed"}, "--closed: there is no curve");
  refused(tilted, {"--machine", "x.machine.toml"}, "--machine: there is no curve");
  refused(tilted, {"--feature", "groove", "--surface", "right"}, "--surface: has no effect");
  refused(tilted, {"--beam-tilt-deg", "1"}, "--beam-tilt-deg: has no effect");
}

}  // namespace
}  // namespace abbe
