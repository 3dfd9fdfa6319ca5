// `abbe position`: the reference's scans, the example, and what is refused.
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cli/command_test.h"

namespace abbe {
namespace {

class PositionTest : public CommandTest {
 protected:
  const std::string engraver = std::string(ABBE_SOURCE_DIR "/examples/laser_engraver/");
  const std::string golden = std::string(ABBE_SOURCE_DIR "/tests/golden/yin/");

  nlohmann::json reference() const {
    std::ifstream file(golden + "positioning.json");
    return nlohmann::json::parse(file);
  }

  /// Rows of a scan of the reference as rows of one target; of the workpiece by the surface of each.
  void add_scan(const std::string& name, const std::string& target, std::string& csv) const {
    static const char* const surfaces[] = {"cylinder", "top", "side"};
    std::ifstream file(golden + "positioning_exact_" + name + ".csv");
    std::string line;
    std::getline(file, line);
    while (std::getline(file, line)) {
      if (!target.empty()) {
        csv += target + "," + line + "\n";
        continue;
      }
      const std::size_t comma = line.rfind(',');
      csv += std::string(surfaces[std::stoul(line.substr(comma + 1))]) + "," + line.substr(0, comma) + "\n";
    }
  }

  std::string write_reference(const std::string& more = "") const {
    std::string csv = "target,x_mm,y_mm,z_mm\n";
    add_scan("PX", "X", csv);
    add_scan("PY", "Y", csv);
    add_scan("C1", "one", csv);
    add_scan("C2", "two", csv);
    add_scan("S", "sphere", csv);
    add_scan("M", "", csv);
    folder.write("scans.csv", csv);
    std::ifstream file(golden + "p0_A4_cylinder.json");
    const nlohmann::json cylinder = nlohmann::json::parse(file);
    std::ostringstream toml;
    toml.precision(17);
    toml << "points = \"scans.csv\"\ncircles = [\"one\", \"two\"]\nsphere_height_mm = 95\n"
         << "moved_since_mm = [150, -60, 0]\nnoise = { target_um = 10, sphere_um = 20 }\n"
         << more
         << "[workpiece]\nnoise_um = 20\n"
         // A degree and some millimetres from initial_DMW of the reference.
         << "start_translation_mm = [-620, -5, 545]\nstart_angles_deg = [-164.5, 24.0, 28.5]\n"
         << "[[workpiece.feature]]\ntarget = \"cylinder\"\nkind = \"cylinder\"\npoint_mm = ["
         << cylinder["cyl_axis_x"].get<double>() << ", " << cylinder["cyl_axis_y"].get<double>()
         << ", 0]\ndirection = [0, 0, 1]\nradius_mm = " << cylinder["R"].get<double>() << "\n"
         << "[[workpiece.feature]]\ntarget = \"top\"\nkind = \"plane\"\npoint_mm = [0, 0, 205]\ndirection = [0, 0, 1]\n"
         << "[[workpiece.feature]]\ntarget = \"side\"\nkind = \"plane\"\npoint_mm = [155, 0, 0]\n"
         << "direction = [1, 0, 0]\n";
    return folder.write("reference.positioning.toml", toml.str());
  }
};

void expect_matrix(const nlohmann::json& found, const nlohmann::json& expected) {
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 4; ++k) {
      EXPECT_NEAR(found[i][k].get<double>(), expected[i][k].get<double>(), k < 3 ? 1e-12 : 1e-9) << i << ", " << k;
    }
  }
}

TEST_F(PositionTest, MeetsTheReferenceInBothReadings) {
  const CommandResult result = abbe({"position", write_reference(), "--json"});
  ASSERT_EQ(result.exit_code, done) << result.err;
  const nlohmann::json json = nlohmann::json::parse(result.out), exact = reference()["exact"];
  EXPECT_EQ(json["status"], "ok");
  expect_matrix(json["scanner"]["table_from_scanner"], exact["DMB"]);
  expect_matrix(json["workpiece"]["workpiece_from_scanner"], exact["DMW"]);
  const nlohmann::json& first = json["workpiece"]["table_to_workpiece"];
  expect_matrix(first["D"], exact["DBW"]);
  const char* const names[] = {"x_mm", "y_mm", "z_mm", "alpha_deg", "beta_deg", "gamma_deg"};
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(first[names[i]].get<double>(), exact["par"][i].get<double>(), 1e-9) << names[i];
    EXPECT_GT(first[std::string("u_") + names[i]].get<double>(), 0) << names[i];
  }
  // The two readings undo each other.
  const nlohmann::json &d = first["D"], &back = json["workpiece"]["workpiece_to_table"]["D"];
  for (std::size_t i = 0; i < 3; ++i) {
    double moved = d[i][3].get<double>();
    for (std::size_t k = 0; k < 3; ++k) moved += d[i][k].get<double>() * back[k][3].get<double>();
    EXPECT_NEAR(moved, 0, 1e-9);
  }
}

TEST_F(PositionTest, ThePlacementIsWhatAPathTakes) {
  const std::string placement = (folder.path() / "part.placement.toml").string();
  const CommandResult found = abbe({"position", engraver + "scanner.positioning.toml", "-o", placement});
  ASSERT_EQ(found.exit_code, done) << found.err;
  EXPECT_NE(found.out.find("p_workpiece = D p_table (BCS to WCS)"), std::string::npos);
  const CommandResult path =
      abbe({"path", engraver + "table-a4.csv", "--machine",
            std::string(ABBE_SOURCE_DIR "/examples/machines/yin-engraver-u.machine.toml"), "--placement", placement});
  EXPECT_EQ(path.exit_code, done) << path.err;
}

TEST_F(PositionTest, ThePlacementMapsTheWayThatIsAskedFor) {
  const std::string file = engraver + "scanner.positioning.toml";
  const auto written = [&](const std::vector<std::string>& options) {
    const std::string placement = (folder.path() / "asked.placement.toml").string();
    std::vector<std::string> words = {"position", file, "--force", "-o", placement};
    words.insert(words.end(), options.begin(), options.end());
    EXPECT_EQ(abbe(words).exit_code, done);
    std::ifstream text(placement);
    return std::string(std::istreambuf_iterator<char>(text), {});
  };
  EXPECT_NE(written({}).find("maps = \"table-to-workpiece\""), std::string::npos);
  EXPECT_NE(written({"--maps", "workpiece-to-table"}).find("maps = \"workpiece-to-table\""), std::string::npos);
  // Without a placement to be written it says nothing.
  const CommandResult result = abbe({"position", file, "--maps", "workpiece-to-table"});
  EXPECT_EQ(result.exit_code, bad_input);
  EXPECT_NE(result.err.find("--maps: there is no placement"), std::string::npos) << result.err;
}

TEST_F(PositionTest, WhatTheScansDoNotShowIsSaid) {
  // The table turned the other way: its axis would point down.
  const CommandResult turned = abbe({"position", write_reference("turned = \"negatively\"\n"), "--json"});
  EXPECT_EQ(turned.exit_code, computation_says_no);
  EXPECT_EQ(nlohmann::json::parse(turned.out)["status"], "no_position");
  EXPECT_NE(turned.err.find("degree"), std::string::npos);
  EXPECT_EQ(abbe({"position", write_reference("spheer = \"sphere\"\n")}).exit_code, bad_input);
  folder.write("scans.csv", "target,x_mm,y_mm,z_mm\nX,1,2,3\n");
  const CommandResult missing = abbe({"position", (folder.path() / "reference.positioning.toml").string()});
  EXPECT_EQ(missing.exit_code, bad_input);
}

}  // namespace
}  // namespace abbe
