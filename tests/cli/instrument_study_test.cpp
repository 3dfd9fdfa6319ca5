#include "cli/instrument_study_test.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>

namespace abbe {
namespace {

using testing::HasSubstr;

TEST_F(InstrumentStudies, ABallBarOnATrunnionMill) {
  const nlohmann::json summary = expect_same_from_files("trunnion", "ball-bar");
  const nlohmann::json& held_out = summary["held_out"];
  EXPECT_LT(held_out["position_after_um"]["mean"].get<double>(),
            0.3 * held_out["position_before_um"]["mean"].get<double>());
  EXPECT_GT(held_out["coverage_percent"].get<double>(), 90);
}

TEST_F(InstrumentStudies, ATrackingInterferometerOnAThreeAxisMill) {
  const nlohmann::json summary = expect_same_from_files("three_axis", "tracking-interferometer");
  const nlohmann::json& held_out = summary["held_out"];
  EXPECT_LT(held_out["position_after_um"]["mean"].get<double>(),
            0.1 * held_out["position_before_um"]["mean"].get<double>());
  EXPECT_GT(held_out["coverage_percent"].get<double>(), 90);
}

TEST_F(InstrumentStudies, ALaserInterferometerAlongEveryLineOfAMill) {
  const nlohmann::json summary = expect_same_from_files("three_axis", "interferometer");
  const nlohmann::json& held_out = summary["held_out"];
  EXPECT_LT(held_out["position_after_um"]["mean"].get<double>(),
            0.1 * held_out["position_before_um"]["mean"].get<double>());
  // The uncertainty is neither too small nor so large that it holds anything: rms error and rms uncertainty agree.
  EXPECT_GT(held_out["coverage_percent"].get<double>(), 85);
  const double expanded = held_out["predicted_expanded_uncertainty_um"]["rms"].get<double>();
  EXPECT_GT(held_out["position_after_um"]["rms"].get<double>(), 0.5 * expanded / 2);
  EXPECT_LT(expanded, 1.5);
  EXPECT_FALSE(held_out.contains("not_determined"));
  std::size_t datum = 0;
  for (const nlohmann::json& advice : summary["not_seen"]) {
    EXPECT_NE(advice["kind"], "not measured")
        << "proposed, though the volumetric error does not depend on it: " << advice;
    datum += advice["kind"] == "datum" ? 1U : 0U;
  }
  EXPECT_GT(datum, 3U) << "rigid motions of the workpiece";
}

TEST_F(InstrumentStudies, ASixComponentLaserWithDiagonals) {
  const nlohmann::json summary = expect_same_from_files("three_axis", "six-component-laser");
  const nlohmann::json& held_out = summary["held_out"];
  EXPECT_LT(held_out["position_after_um"]["mean"].get<double>(),
            0.1 * held_out["position_before_um"]["mean"].get<double>());
  EXPECT_GT(held_out["coverage_percent"].get<double>(), 85);
  EXPECT_LT(held_out["predicted_expanded_uncertainty_um"]["rms"].get<double>(), 1.0);
  EXPECT_FALSE(held_out.contains("not_determined"));
}

TEST_F(InstrumentStudies, WhatLasersLeaveOpenIsSaidWithItsSize) {
  // Without the step diagonal no reading shows how the roll of X grows along X.
  std::ifstream file(std::string(ABBE_SOURCE_DIR "/examples/three_axis/interferometer.study.toml"));
  std::stringstream content;
  content << file.rdbuf();
  std::string text = content.str();
  const std::size_t from = text.find("# --- Step diagonal"), to = text.find("[identify]");
  ASSERT_NE(from, std::string::npos);
  text.erase(from, to - from);
  const std::string relative = "machine = \"../";
  text.replace(text.find(relative), relative.size(), "machine = \"" + std::string(ABBE_SOURCE_DIR "/examples/"));
  folder.write("open.study.toml", text);
  const CommandResult result = abbe({"run", "open.study.toml", "-o", "out", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const nlohmann::json summary = nlohmann::json::parse(result.out);
  const nlohmann::json& held_out = summary["held_out"];
  ASSERT_TRUE(held_out.contains("not_determined"));
  EXPECT_THAT(held_out["not_determined"].dump(), HasSubstr("slope of the reference straight line of EAX"));
  std::string proposed;
  for (const nlohmann::json& advice : summary["not_seen"]) {
    if (advice["kind"] == "not measured")
      proposed += advice["text"].get<std::string>() + ": " + advice["remedy"].get<std::string>();
  }
  EXPECT_THAT(proposed, HasSubstr("slope of EAX"));
  EXPECT_THAT(proposed, HasSubstr("would show it"));
  // What is open is real: it is most of the error that is left, and not within the uncertainty of what is seen.
  const double left = held_out["position_after_um"]["rms"].get<double>();
  EXPECT_GT(held_out["not_determined_rms_um"].get<double>(), 0.5 * left);
  EXPECT_GT(left, held_out["predicted_expanded_uncertainty_um"]["rms"].get<double>());
  // The part that is seen is as certain as stated.
  EXPECT_GT(held_out["coverage_percent"].get<double>(), 80);
}

TEST_F(InstrumentStudies, ACircleOutOfReachIsSaid) {
  folder.write("bar.study.toml", "machine = \"" + std::string(ABBE_SOURCE_DIR) +
                                     "/examples/machines/trunnion-mill.machine.toml\"\n"
                                     "[simulate.generator]\nmean_volumetric_um = 10\n"
                                     "[[setup]]\nname = \"bar\"\ninstrument = \"ball-bar\"\n"
                                     "spindle_ball_mm = [0, 0, -150]\nnoise = { length_um = 1 }\n"
                                     "[[setup.ball]]\nname = \"B\"\ncentre_mm = [0, 0, 60]\n"
                                     "[[setup.plan]]\nkind = \"circle\"\nplane = [\"X\", \"Y\"]\nradius_mm = 1000\n"
                                     "points = 8\n[identify]\n[[identify.motion]]\nerrors = \"EXX\"\n"
                                     "basis = \"legendre\"\norder = 1\n");
  const CommandResult result = abbe({"run", "bar.study.toml", "-o", "out"});
  EXPECT_EQ(result.exit_code, bad_input);
  EXPECT_THAT(result.err, HasSubstr("the circle is out of reach of the linear axes at"));
}

TEST_F(InstrumentStudies, PosesOfAFileAreVisitedInItsOrderWhateverTheirItems) {
  const std::string machine = std::string(ABBE_SOURCE_DIR "/examples/machines/trunnion-mill.machine.toml");
  const auto study = [&](const char* more) {
    folder.write("s.study.toml",
                 "name = \"s\"\nmachine = \"" + machine +
                     "\"\n[simulate]\n[simulate.generator]\nseed = 1\nmean_volumetric_um = 40\n[[setup]]\nname = "
                     "\"bar\"\ninstrument = \"ball-bar\"\nspindle_ball_mm = [0, 0, -150]\nnoise = { length_um = 1 "
                     "}\n[[setup.ball]]\nname = \"B1\"\ncentre_mm = [0, 0, 60]\n[[setup.ball]]\nname = \"B2\"\n"
                     "centre_mm = [70, 0, 60]\n[[setup.plan]]\nkind = \"poses\"\nfile = \"poses.csv\"\n" +
                     more);
  };
  /// Items and X of the readings, in their order.
  const auto visited = [&] {
    const CommandResult result = abbe({"simulate", "s.study.toml", "-o", "readings"});
    EXPECT_EQ(result.exit_code, ExitCode::done) << result.err;
    std::istringstream lines(folder.read("readings/bar.csv"));
    std::string text, line;
    std::size_t item = 0, x = 0;
    while (std::getline(lines, line)) {
      std::vector<std::string> fields;
      std::istringstream row(line);
      for (std::string field; std::getline(row, field, ',');) fields.push_back(field);
      const auto column = [&](const char* name) {
        return static_cast<std::size_t>(std::find(fields.begin(), fields.end(), name) - fields.begin());
      };
      if (column("X_mm") < fields.size()) {
        x = column("X_mm");
        item = column("item");
      } else if (x > 0 && item < fields.size()) {
        text += fields[item] + "@" + fields[x] + " ";
      }
    }
    std::filesystem::remove_all(folder.path() / "readings");
    return text;
  };
  folder.write("poses.csv", "C_deg,A_deg,Y_mm,X_mm,Z_mm,item\n0,0,0,10,-250,B2\n0,0,0,20,-250,B1\n0,0,0,30,-250,B2\n");
  study("");
  EXPECT_EQ(visited(), "B2@10 B1@20 B2@30 ");
  study("repeats = 2\nthere_and_back = true\n");
  EXPECT_EQ(visited(), "B2@10 B1@20 B2@30 B2@30 B1@20 B2@10 ");
  // Without a column every item is measured at a pose before the next one.
  folder.write("poses.csv", "C_deg,A_deg,Y_mm,X_mm,Z_mm\n0,0,0,10,-250\n0,0,0,20,-250\n");
  study("");
  EXPECT_EQ(visited(), "B1@10 B2@10 B1@20 B2@20 ");
}

}  // namespace
}  // namespace abbe
