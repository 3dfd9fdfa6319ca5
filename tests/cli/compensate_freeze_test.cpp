// `abbe compensate freeze`: the file, what is said of it, and what is refused.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "cli/command_test.h"

namespace abbe {
namespace {

class CompensateFreezeTest : public CommandTest {
 protected:
  const std::string machine = std::string(ABBE_SOURCE_DIR "/examples/machines/trunnion-mill.machine.toml");
  const std::string errors = std::string(ABBE_SOURCE_DIR "/examples/trunnion/table.errors.toml");
  const std::string output = (folder.path() / "mill.abbec").string();
};

TEST_F(CompensateFreezeTest, WritesAFileAndSaysWhatItDoes) {
  const CommandResult result =
      abbe({"compensate", "freeze", "--machine", machine, "--errors", errors, "-o", output, "--json"});
  ASSERT_EQ(result.exit_code, done) << result.err;
  const nlohmann::json json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json["bytes"].get<std::size_t>(), std::filesystem::file_size(output));
  EXPECT_EQ(json["format"], 2);
  EXPECT_EQ(json["checksum"].get<std::string>().size(), 16U);
  EXPECT_GT(json["largest_correction_um"].get<double>(), 1);
  EXPECT_LT(json["accuracy_mm"].get<double>(), 1e-9);
  EXPECT_GE(json["worst_iterations"].get<int>(), 2);
  const CommandResult again =
      abbe({"compensate", "freeze", "--machine", machine, "--errors", errors, "--force", "-o", output});
  EXPECT_NE(again.out.find(json["checksum"].get<std::string>()), std::string::npos);
  EXPECT_NE(again.out.find("largest correction of the tool: "), std::string::npos);
}

TEST_F(CompensateFreezeTest, TakesErrorsThatDependOnStates) {
  const std::string mill = (folder.path() / "warm.machine.toml").string();
  const std::string warm = (folder.path() / "warm.errors.toml").string();
  std::ofstream(mill) << "name = \"warm mill\"\nchain = \"w X' Y' b Z t\"\n"
                         "[axis.X]\ntravel_mm = [0, 500]\n[axis.Y]\ntravel_mm = [0, 400]\n"
                         "[axis.Z]\ntravel_mm = [-300, 0]\n[tool]\nreference_mm = [0, 0, 500]\n"
                         "[state.ambient]\nkind = \"measured\"\nunit = \"degC\"\n"
                         "[state.column]\nkind = \"lag\"\nof = \"ambient\"\ntime_constant_s = 1800\n"
                         "[state.load]\nkind = \"measured\"\nunit = \"kg\"\n";
  std::ofstream(warm) << "[[motion]]\nname = \"EXX\"\nstate = \"ambient\"\nbasis = \"legendre\"\norder = 1\n"
                         "coefficients_um = [1, 2]\n"
                         "[[location]]\nname = \"EC0Y\"\nstate = \"column\"\nvalue_urad = 3\n"
                         "[[motion]]\nname = \"EZZ\"\nstate = \"load\"\nbasis = \"legendre\"\norder = 0\n"
                         "coefficients_um = [0.1]\n";
  const auto freeze = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words{"compensate", "freeze",  "--machine", mill,  "--errors",
                                   warm,         "--force", "-o",        output};
    words.insert(words.end(), more.begin(), more.end());
    return abbe(words);
  };
  const CommandResult without = freeze({});
  EXPECT_EQ(without.exit_code, bad_input);
  EXPECT_NE(without.err.find("--state-range load_kg=FROM:TO"), std::string::npos) << without.err;
  const CommandResult result = freeze({"--state-range", "ambient_degC=16:28", "load_kg=0:200", "--json"});
  ASSERT_EQ(result.exit_code, done) << result.err;
  const nlohmann::json json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json["format"], 3);
  ASSERT_EQ(json["states"].size(), 2U);
  EXPECT_EQ(json["states"][0]["name"], "ambient");
  EXPECT_EQ(json["states"][0]["range"], (std::vector<double>{16, 28}));
  // 8 K times 3 um per K of EXX at the end, and times 3 urad per K over 400 mm of EC0Y.
  EXPECT_NEAR(json["states"][0]["largest_um"].get<double>(), 8 * (3 + 1.2), 0.05);
  EXPECT_LT(json["accuracy_mm"].get<double>(), 1e-9);
  const CommandResult text = freeze({"--state-range", "ambient_degC=16:28", "load_kg=0:200"});
  EXPECT_NE(text.out.find("  state ambient: 16 to 28 degC, reference 20; moves the tool by up to "), std::string::npos);
  const CommandResult checked = abbe({"check", output});
  EXPECT_EQ(checked.exit_code, done) << checked.err;
  EXPECT_NE(checked.out.find("  state column: lag of ambient, 1800 s\n"), std::string::npos) << checked.out;
  for (const char* const wrong : {"cold=1:2", "ambient=16:28", "ambient_degC=28:16", "ambient_degC=16", "ambient_degC",
                                  "column_degC=16:28", "load_kg=x:2"}) {
    const CommandResult refused = freeze({"--state-range", wrong});
    EXPECT_EQ(refused.exit_code, bad_input) << wrong;
    EXPECT_NE(refused.err.find("--state-range " + std::string(wrong) + ": "), std::string::npos) << refused.err;
  }
  std::ofstream(warm, std::ios::app) << "[covered]\nambient_degC = [17, 24]\nload_kg = [0, 80]\n";
  const CommandResult covered = freeze({});
  EXPECT_EQ(covered.exit_code, done) << covered.err;
  EXPECT_NE(covered.out.find("  state ambient: 17 to 24 degC, "), std::string::npos) << covered.out;
  const CommandResult left_out = freeze({"--state-range", "load_kg=0:200", "--leave-out-below-uncertainty", "1"});
  EXPECT_EQ(left_out.exit_code, bad_input);
  EXPECT_NE(left_out.err.find("EXX*ambient"), std::string::npos) << left_out.err;
}

TEST_F(CompensateFreezeTest, SaysWhyManyStatesHaveNoUncertainty) {
  const std::string mill = (folder.path() / "many.machine.toml").string();
  const std::string warm = (folder.path() / "many.errors.toml").string();
  std::string states, errors_text;
  const auto text_with = [&](int count) {
    states =
        "name = \"mill\"\nchain = \"w X' b Z t\"\n[axis.X]\ntravel_mm = [0, 500]\n[axis.Z]\n"
        "travel_mm = [-300, 0]\n";
    errors_text.clear();
    for (int i = 0; i < count; ++i) {
      const std::string name = "t" + std::to_string(i);
      states += "[state." + name + "]\nkind = \"measured\"\nunit = \"degC\"\n";
      errors_text +=
          "[[motion]]\nname = \"EXX\"\nstate = \"" + name +
          "\"\nbasis = \"legendre\"\norder = 1\ncoefficients_um = [0, 1]\nstandard_uncertainty_um = [0, 0.1]\n";
    }
    std::ofstream(mill) << states;
    std::ofstream(warm) << errors_text;
    return abbe({"compensate", "freeze", "--machine", mill, "--errors", warm, "--dry-run"});
  };
  const CommandResult eight = text_with(8), nine = text_with(9);
  ASSERT_EQ(eight.exit_code, done) << eight.err;
  EXPECT_NE(eight.out.find(" um on average, at most "), std::string::npos) << eight.out;
  ASSERT_EQ(nine.exit_code, done) << nine.err;
  EXPECT_NE(nine.out.find("not in the file, because the errors depend on more than eight states"), std::string::npos)
      << nine.out;
}

TEST_F(CompensateFreezeTest, AnArmIsRefusedAsNothingIsKnownOfWhatRemains) {
  const std::string arm = (folder.path() / "arm.machine.toml").string();
  const std::string arm_errors = (folder.path() / "arm.errors.toml").string();
  std::ofstream(arm) << "name = \"arm\"\nchain = \"w b C1 B1 B2 A1 B3 A2 t\"\n"
                        "[axis.C1]\ntravel_deg = [-165, 165]\npoint_mm = [0, 0, 0]\n"
                        "[axis.B1]\ntravel_deg = [-110, 110]\npoint_mm = [0, 0, 290]\n"
                        "[axis.B2]\ntravel_deg = [-110, 70]\npoint_mm = [0, 0, 560]\n"
                        "[axis.A1]\ntravel_deg = [-160, 160]\npoint_mm = [0, 0, 630]\n"
                        "[axis.B3]\ntravel_deg = [-120, 120]\npoint_mm = [302, 0, 630]\n"
                        "[axis.A2]\ntravel_deg = [-400, 400]\npoint_mm = [374, 0, 630]\n"
                        "[tool]\nreference_mm = [374, 0, 630]\ndirection = [-1, 0, 0]\n";
  std::ofstream(arm_errors) << "[[motion]]\nname = \"EZB1\"\nbasis = \"legendre\"\norder = 1\n"
                               "coefficients_um = [20, 30]\n";
  const CommandResult result = abbe({"compensate", "freeze", "--machine", arm, "--errors", arm_errors, "-o", output});
  EXPECT_EQ(result.exit_code, 1) << result.err;
  EXPECT_NE(result.err.find("at none of 12000 poses"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("has no such axes"), std::string::npos) << result.err;
  EXPECT_NE(result.out.find("not known"), std::string::npos) << result.out;
  EXPECT_EQ(result.out.find("0.0e+00 mm"), std::string::npos) << result.out;
  EXPECT_FALSE(std::filesystem::exists(output));
  const CommandResult as_json =
      abbe({"compensate", "freeze", "--machine", arm, "--errors", arm_errors, "--dry-run", "--json"});
  EXPECT_EQ(as_json.exit_code, 1);
  EXPECT_TRUE(nlohmann::json::parse(as_json.out)["accuracy_mm"].is_null());
}

TEST_F(CompensateFreezeTest, TheFileCarriesTheUncertaintyOfTheErrors) {
  const std::string uncertain = std::string(ABBE_SOURCE_DIR "/examples/compensate/trunnion.errors.toml");
  const CommandResult result = abbe({"compensate", "freeze", "--machine", machine, "--errors", uncertain, "-o", output,
                                     "--leave-out-below-uncertainty", "2", "--json"});
  ASSERT_EQ(result.exit_code, done) << result.err;
  const nlohmann::json json = nlohmann::json::parse(result.out);
  EXPECT_GT(json["mean_standard_uncertainty_um"].get<double>(), 0.5);
  EXPECT_GT(json["largest_standard_uncertainty_um"], json["mean_standard_uncertainty_um"]);
  EXPECT_LT(json["largest_standard_uncertainty_um"].get<double>(), 20);
  EXPECT_LT(json["standard_uncertainty_in_file_to_um"].get<double>(),
            0.5 * json["mean_standard_uncertainty_um"].get<double>());
  // As `abbe compensate gcode` leaves it out.
  const auto left_out = json["left_out"].get<std::vector<std::string>>();
  EXPECT_NE(std::find(left_out.begin(), left_out.end(), "EAX"), left_out.end());
  // The machine has what is left out, and the file names the errors that it comes from.
  const nlohmann::json all =
      nlohmann::json::parse(abbe({"compensate", "freeze", "--machine", machine, "--errors", uncertain, "-o",
                                  (folder.path() / "all.abbec").string(), "--json"})
                                .out);
  EXPECT_LT(all["accuracy_mm"].get<double>(), 1e-9);
  EXPECT_GT(json["accuracy_mm"].get<double>(), 1e-4);
  EXPECT_LT(json["difference_by_freezing_mm"].get<double>(), 1e-9);
  EXPECT_EQ(json["source_checksum"], all["source_checksum"]);
  EXPECT_NE(json["checksum"], all["checksum"]);
  const CommandResult without =
      abbe({"compensate", "freeze", "--machine", machine, "--errors", errors, "--force", "-o", output});
  EXPECT_NE(without.out.find("not stated by the errors file"), std::string::npos) << without.out;
}

TEST_F(CompensateFreezeTest, CheckSaysWhatIsInAFileAndRefusesADamagedOne) {
  const nlohmann::json made = nlohmann::json::parse(
      abbe({"compensate", "freeze", "--machine", machine, "--errors", errors, "-o", output, "--json"}).out);
  const CommandResult whole = abbe({"check", output, "--json"});
  ASSERT_EQ(whole.exit_code, done) << whole.err;
  const nlohmann::json json = nlohmann::json::parse(whole.out);
  EXPECT_EQ(json["checksum"], made["checksum"]);
  EXPECT_EQ(json["source_checksum"], made["source_checksum"]);
  EXPECT_NEAR(json["largest_correction_um"].get<double>(), made["largest_correction_um"].get<double>(), 1e-6);
  EXPECT_NE(abbe({"check", output}).out.find("frozen compensation of trunnion mill, whole"), std::string::npos);
  const std::string bytes = folder.read(std::filesystem::path(output).filename().string());
  std::string changed = bytes;
  changed[changed.size() / 2] = static_cast<char>(changed[changed.size() / 2] ^ 1);
  for (const std::string& damaged :
       {bytes.substr(0, bytes.size() - 1), bytes.substr(0, 100), bytes + "x", changed, std::string("chain = 1")}) {
    const CommandResult refused = abbe({"check", folder.write("damaged.abbec", damaged).string()});
    EXPECT_EQ(refused.exit_code, bad_input) << damaged.size();
    EXPECT_NE(refused.err.find("damaged.abbec: "), std::string::npos) << refused.err;
    EXPECT_NE(refused.err.find("expected a whole file of abbe compensate freeze"), std::string::npos) << refused.err;
  }
  EXPECT_EQ(abbe({"check", output, "--errors", errors}).exit_code, bad_input);
}

TEST_F(CompensateFreezeTest, ACorrectionAboveTheLimitIsRefusedWithItsPlace) {
  const CommandResult result =
      abbe({"compensate", "freeze", "--machine", machine, "--errors", errors, "-o", output, "--limit-um", "1"});
  EXPECT_EQ(result.exit_code, computation_says_no);
  EXPECT_NE(result.err.find("above --limit-um 1, at C "), std::string::npos) << result.err;
  EXPECT_FALSE(std::filesystem::exists(output));
}

TEST_F(CompensateFreezeTest, TheLargestCorrectionIsThatOfTheCornerWhereErrorsAddUp) {
  // Along X from 0 to 60 um over the travel of each axis; those that carry the workpiece count against the others.
  std::string text;
  for (const std::string axis : {"X", "Z", "Y", "A"}) {
    const std::string size = axis == "X" || axis == "Z" ? "30" : "-30";
    text += "[[motion]]\nname = \"EX" + axis + "\"\nbasis = \"legendre\"\norder = 1\ncoefficients_um = [" + size +
            ", " + size + "]\n";
  }
  text += "[[motion]]\nname = \"EXC\"\nbasis = \"fourier\"\norder = 1\ncoefficients_um = [-30, -30, 0]\n";
  folder.write("corner.errors.toml", text);
  const CommandResult result = abbe({"compensate", "freeze", "--machine", machine, "--errors", "corner.errors.toml",
                                     "--dry-run", "--json", "--tool-length-mm", "100", "100"});
  ASSERT_EQ(result.exit_code, done) << result.err;
  EXPECT_NEAR(nlohmann::json::parse(result.out)["largest_correction_um"].get<double>(), 300, 1e-3);
  // The limit goes by it; what is refused is reported all the same.
  const CommandResult above = abbe({"compensate", "freeze", "--machine", machine, "--errors", "corner.errors.toml",
                                    "-o", output, "--json", "--limit-um", "299.99"});
  EXPECT_EQ(above.exit_code, computation_says_no);
  const nlohmann::json json = nlohmann::json::parse(above.out);
  EXPECT_EQ(json["written"], false);
  EXPECT_NEAR(json["largest_correction_um"].get<double>(), 300, 1e-3);
  EXPECT_FALSE(std::filesystem::exists(output));
}

TEST_F(CompensateFreezeTest, ADryRunSaysWhereEveryJointIsCorrectedMostAndWritesNothing) {
  const CommandResult result = abbe({"compensate", "freeze", "--machine", machine, "--errors", errors, "--dry-run"});
  ASSERT_EQ(result.exit_code, done) << result.err;
  EXPECT_NE(result.out.find("dry run, nothing written"), std::string::npos) << result.out;
  for (const std::string joint : {"C", "A", "Y", "X", "Z"}) {
    const std::size_t at = result.out.find("largest correction of " + joint + ":");
    ASSERT_NE(at, std::string::npos) << joint;
    EXPECT_NE(result.out.substr(at, result.out.find('\n', at) - at).find(" at C "), std::string::npos) << joint;
  }
  EXPECT_EQ(
      abbe({"compensate", "freeze", "--machine", machine, "--errors", errors, "--dry-run", "-o", output}).exit_code,
      done);
  EXPECT_FALSE(std::filesystem::exists(output));
  EXPECT_EQ(abbe({"compensate", "freeze", "--machine", machine, "--errors", errors}).exit_code, bad_input);
}

TEST_F(CompensateFreezeTest, InputsAreNeverWrittenOver) {
  std::filesystem::copy(errors, folder.path() / "mine.errors.toml");
  std::filesystem::create_symlink("mine.errors.toml", folder.path() / "link.abbec");
  const std::string before = folder.read("mine.errors.toml");
  for (const std::string name : {"mine.errors.toml", "./mine.errors.toml", "link.abbec"}) {
    const CommandResult result =
        abbe({"compensate", "freeze", "--machine", machine, "--errors", "mine.errors.toml", "--force", "-o", name});
    EXPECT_EQ(result.exit_code, bad_input);
    EXPECT_NE(result.err.find("is an input of the command"), std::string::npos) << result.err;
    EXPECT_EQ(folder.read("mine.errors.toml"), before);
  }
}

TEST_F(CompensateFreezeTest, BadOptionsAreNamed) {
  const auto refused = [&](std::vector<std::string> options, const std::string& name) {
    std::vector<std::string> arguments{"compensate", "freeze", "--machine", machine, "--errors", errors, "-o", output};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const CommandResult result = abbe(arguments);
    EXPECT_EQ(result.exit_code, bad_input);
    EXPECT_NE(result.err.find(name), std::string::npos) << result.err;
  };
  refused({"--tool-length-mm", "200", "100"}, "--tool-length-mm");
  refused({"--limit-um", "-3"}, "--limit-um");
  refused({"--limit-um", "nan"}, "--limit-um");
  // These errors state no uncertainties.
  refused({"--leave-out-below-uncertainty", "2"}, "no standard uncertainties are stated");
  refused({"--world", "moon"}, "--world");
  refused({"--largest-turn-deg", "40"}, "--largest-turn-deg");
  refused({"--leave-out-below-uncertainty", "-1"}, "--leave-out-below-uncertainty");
  EXPECT_FALSE(std::filesystem::exists(output));
}

TEST_F(CompensateFreezeTest, ReversalValuesAreLinesForTheControlsOwnBacklash) {
  std::ifstream file(errors);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  std::ofstream(folder.path() / "r.errors.toml") << text << "\n[[reversal]]\naxis = \"Y\"\nvalue_um = -12\n"
                                                 << "[[reversal]]\naxis = \"C\"\nvalue_urad = 35\n";
  const CommandResult result =
      abbe({"compensate", "freeze", "--machine", machine, "--errors", "r.errors.toml", "-o", output});
  ASSERT_EQ(result.exit_code, done) << result.err;
  EXPECT_EQ(result.err, "");
  EXPECT_NE(result.out.find("[JOINT_1]BACKLASH = 0.0120000    (Y, mm"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("[JOINT_4]BACKLASH    0.0020054 deg less"), std::string::npos) << result.out;
  const nlohmann::json json = nlohmann::json::parse(abbe({"compensate", "freeze", "--machine", machine, "--errors",
                                                          "r.errors.toml", "--force", "-o", output, "--json"})
                                                        .out);
  ASSERT_EQ(json["backlash"].size(), 2U);
  EXPECT_EQ(json["backlash"][0]["axis"], "Y");
  EXPECT_NEAR(json["backlash"][0]["lost_motion_mm"].get<double>(), 0.012, 1e-12);
}

TEST_F(CompensateFreezeTest, JointsAreNumberedAsInTablesAndByTheLinuxCncModule) {
  const std::string axes = folder
                               .write("five.machine.toml", R"(
name = "five"
chain = "w C1' Y' X' b Z U t"
[axis.C1]
endless = true
[axis.Y]
travel_mm = [-100, 100]
[axis.X]
travel_mm = [-100, 100]
[axis.Z]
travel_mm = [-100, 100]
[axis.U]
direction = [1, 0, 0]
travel_mm = [-50, 50]
)")
                               .string();
  const std::string play = folder
                               .write("five.errors.toml", R"(
[[reversal]]
axis = "C1"
value_urad = -35
[[reversal]]
axis = "U"
value_um = -12
)")
                               .string();
  const CommandResult result =
      abbe({"compensate", "freeze", "--machine", axes, "--errors", play, "-o", output, "--json"});
  ASSERT_EQ(result.exit_code, done) << result.err;
  const nlohmann::json backlash = nlohmann::json::parse(result.out)["backlash"];
  ASSERT_EQ(backlash.size(), 2U);
  EXPECT_EQ(backlash[0]["axis"], "U");
  EXPECT_EQ(backlash[0]["setting"], "[JOINT_3]BACKLASH");
  EXPECT_EQ(backlash[1]["axis"], "C1");
  EXPECT_EQ(backlash[1]["setting"], "[JOINT_4]BACKLASH");
  const CommandResult table =
      abbe({"compensate", "table", "--machine", axes, "--errors", play, "--for", "linuxcnc", "--dry-run", "--json"});
  const nlohmann::json tables = nlohmann::json::parse(table.out, nullptr, false);
  ASSERT_TRUE(tables.is_object()) << table.err;
  for (const nlohmann::json& error : tables["errors"]) {
    const std::string joint = error["name"] == "reversal_C1" ? "of joint 4;" : "of joint 3;";
    EXPECT_NE(error["control"].get<std::string>().find(joint), std::string::npos) << error;
  }
}

}  // namespace
}  // namespace abbe
