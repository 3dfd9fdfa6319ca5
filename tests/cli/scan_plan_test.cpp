#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "cli/command_test.h"

namespace abbe {
namespace {

class ScanPlanCommand : public CommandTest {
 protected:
  const std::string examples = std::string(ABBE_SOURCE_DIR "/examples/");
  const std::string machine = examples + "machines/liu-scanner.machine.toml";
  const std::string pyramid = examples + "cradle_scanner/pyramid.stl";
};

TEST_F(ScanPlanCommand, CoversThePyramidAndWritesPathProgramAndCoverage) {
  const CommandResult result =
      abbe({"scan", "plan", pyramid, "--machine", machine, "--along-mm", "1", "--between-mm", "1", "-o", "path.csv",
            "--program", "path.ngc", "--coverage", "coverage.ply", "--json"});
  ASSERT_EQ(result.exit_code, ExitCode::done) << result.err;
  const nlohmann::json json = nlohmann::json::parse(result.out);
  ASSERT_EQ(json["faces"].size(), 10U);
  for (const nlohmann::json& face : json["faces"]) EXPECT_EQ(face["path"], "raster");
  EXPECT_GT(json["covered_percent"].get<double>(), 99.0);
  EXPECT_EQ(json["missed"], 0);
  std::istringstream path(folder.read("path.csv"));
  std::string line;
  std::getline(path, line);
  EXPECT_EQ(line, "time_s,C_deg,A_deg,X_mm,Y_mm,Z_mm,measures,blocked,face,line,x_mm,y_mm,z_mm,i,j,k");
  const std::string program = folder.read("path.ngc");
  EXPECT_NE(program.find("\nG93\n"), std::string::npos);
  EXPECT_NE(program.find("(face 10 line 1, raster)"), std::string::npos);
  EXPECT_TRUE(program.ends_with("G94\nM2\n"));
  EXPECT_EQ(folder.read("coverage.ply").substr(0, 4), "ply\n");
}

/// Blocks of a program by the grammar of RS-274/NGC (Kramer, Proctor, Messina, NISTIR 6556): words of one letter and a
/// number, none twice but G, comments without parentheses in them, an F with every G1 while G93 holds, M2 last.
struct Block {
  std::map<char, double> words;
  std::vector<double> modes;  ///< numbers of the G words
};

std::vector<Block> blocks_of(const std::string& program) {
  std::vector<Block> blocks;
  std::istringstream text(program);
  std::string line;
  bool inverse_time = false;
  while (std::getline(text, line)) {
    EXPECT_LE(line.size(), 255U);
    Block block;
    for (std::size_t at = 0; at < line.size();) {
      const char letter = line[at];
      if (letter == ' ') {
        ++at;
        continue;
      }
      if (letter == '(') {
        const std::size_t end = line.find(')', at);
        EXPECT_NE(end, std::string::npos) << line;
        if (end == std::string::npos) return blocks;
        EXPECT_EQ(line.substr(at + 1, end - at - 1).find('('), std::string::npos) << line;
        at = end + 1;
        continue;
      }
      EXPECT_TRUE(std::string("GFMXYZABC").find(letter) != std::string::npos) << line;
      std::size_t length = 0;
      const std::string number = line.substr(at + 1);
      // Digits with a sign and a point, no exponent.
      while (length < number.size() && std::string("+-.0123456789").find(number[length]) != std::string::npos) ++length;
      std::size_t read = 0;
      const double value = length > 0 ? std::stod(number.substr(0, length), &read) : 0;
      EXPECT_TRUE(length > 0 && read == length) << line;
      if (length == 0) return blocks;
      if (letter == 'G') {
        block.modes.push_back(value);
      } else {
        EXPECT_TRUE(block.words.emplace(letter, value).second) << "twice " << letter << ": " << line;
      }
      at += 1 + length;
    }
    if (block.words.empty() && block.modes.empty()) continue;
    const auto has = [&](double mode) { return std::count(block.modes.begin(), block.modes.end(), mode) > 0; };
    EXPECT_FALSE(has(93) && has(94)) << line;
    inverse_time = (inverse_time || has(93)) && !has(94);
    if (has(1)) {
      EXPECT_TRUE(inverse_time && block.words.count('F') == 1 && block.words['F'] > 0) << line;
    }
    blocks.push_back(block);
  }
  return blocks;
}

TEST_F(ScanPlanCommand, WritesAProgramThatKeepsTheGrammarAndSaysWhatTheCsvSays) {
  const CommandResult result =
      abbe({"scan",     "plan",         pyramid, "--machine",         machine,     "--along-mm",
            "2",        "--between-mm", "2",     "--beyond-plane-mm", "0",         "1",
            "0",        "-0.8",         "-o",    "path.csv",          "--program", "path.ngc",
            "--report", "plan.html"});
  ASSERT_EQ(result.exit_code, ExitCode::done) << result.err;
  const std::vector<Block> blocks = blocks_of(folder.read("path.ngc"));
  ASSERT_GT(blocks.size(), 50U);
  EXPECT_EQ(blocks.back().words.at('M'), 2);
  std::istringstream path(folder.read("path.csv"));
  std::string line;
  std::getline(path, line);
  std::size_t at = 0;
  double last = 0;
  while (std::getline(path, line)) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream fields(line);
    double time = 0;
    fields >> time;
    while (at < blocks.size() && blocks[at].words.count('X') == 0) ++at;
    ASSERT_LT(at, blocks.size()) << line;
    for (const char axis : {'C', 'A', 'X', 'Y', 'Z'}) {
      double position = 0;
      fields >> position;
      EXPECT_NEAR(blocks[at].words.at(axis), position, 1e-6) << line;
    }
    if (last > 0) {
      EXPECT_NEAR(60 / blocks[at].words.at('F'), time - last, 2e-4) << line;
    }
    last = time;
    ++at;
  }
  while (at < blocks.size()) EXPECT_EQ(blocks[at++].words.count('X'), 0U);
}

/// The data in a page.
nlohmann::json data_of(const std::string& page) {
  const std::string begin = "id=\"abbe-data\">";
  const std::size_t from = page.find(begin);
  if (from == std::string::npos) return {};
  return nlohmann::json::parse(page.substr(from + begin.size(), page.find("</script>", from) - from - begin.size()));
}

TEST_F(ScanPlanCommand, ThePageHoldsPathAndCoverageWithTheFiguresOfTheSummary) {
  // Turned and moved, what is asked for cut by a plane, and a thick probe over a plate: several reasons.
  folder.write("plate.obj", "v -60 -20.1 -60\nv 60 -20.1 -60\nv 60 -20.1 60\nv -60 -20.1 60\nf 1 4 3\nf 1 3 2\n");
  std::vector<std::string> command{"scan",    "plan",      pyramid,    "--machine", machine,
                                   "--stage", "plate.obj", "--report", "plan.html"};
  for (const char* text : {"--along-mm",
                           "2",
                           "--between-mm",
                           "2",
                           "--probe-radius-mm",
                           "9",
                           "--largest-angle-deg",
                           "15",
                           "--position-mm",
                           "3",
                           "0",
                           "1",
                           "--turn-deg",
                           "0",
                           "20",
                           "0",
                           "--beyond-plane-mm",
                           "0",
                           "1",
                           "0",
                           "-19"}) {
    command.emplace_back(text);
  }
  const CommandResult words = abbe(command);
  ASSERT_EQ(words.exit_code, ExitCode::computation_says_no) << words.err;
  command.insert(command.end(), {"--json", "--force"});
  const nlohmann::json summary = nlohmann::json::parse(abbe(command).out);
  const nlohmann::json page = data_of(folder.read("plan.html"));
  ASSERT_TRUE(page.is_object());

  const nlohmann::json& coverage = page["surface"]["coverage"];
  std::map<std::string, double> uncovered;
  for (const nlohmann::json& face : summary["faces"]) {
    for (const auto& [reason, area] : face["uncovered_mm2"].items()) uncovered[reason] += area.get<double>();
  }
  ASSERT_GE(uncovered.size(), 2U);
  ASSERT_EQ(coverage["percent"].size(), 1 + uncovered.size());
  ASSERT_EQ(coverage["reasons"].size(), 2 + uncovered.size());
  EXPECT_EQ(coverage["reasons"].back(), "not asked for");
  double sum = 0;
  for (const nlohmann::json& share : coverage["percent"]) sum += share.get<double>();
  EXPECT_NEAR(sum, 100, 1e-9);
  EXPECT_NEAR(coverage["percent"][0].get<double>(), summary["covered_percent"].get<double>(), 1e-12);
  std::map<std::string, double> figures;
  for (const nlohmann::json& figure : page["evaluation"]["figures"]) {
    for (const char* key : {"value_percent", "value_s", "value_um", "value"}) {
      if (figure.contains(key)) figures[figure["symbol"].get<std::string>()] = figure[key].get<double>();
    }
  }
  EXPECT_EQ(figures.at("points"), summary["points"].get<double>());
  EXPECT_EQ(figures.at("missed"), summary["missed"].get<double>());
  EXPECT_EQ(figures.at("blocked"), summary["blocked_links"].get<double>());
  EXPECT_NEAR(figures.at("time"), summary["time_s"].get<double>(), 1e-9);
  EXPECT_NEAR(figures.at("covered"), summary["covered_percent"].get<double>(), 1e-12);
  const double area = summary["area_mm2"].get<double>();
  for (const auto& [reason, part] : uncovered) {
    EXPECT_NEAR(figures.at(reason), 100 * part / area, 1e-9) << reason;
    // As printed for people.
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "not covered %6.2f %%: ", figures.at(reason));
    EXPECT_NE(words.out.find(text.data()), std::string::npos) << words.out;
  }
  std::array<char, 32> covered{};
  std::snprintf(covered.data(), covered.size(), "%.1f %% of %.1f mm2", figures.at("covered"), area);
  EXPECT_NE(words.out.find(covered.data()), std::string::npos) << words.out;

  // The path is where the part is: both in the workpiece frame, the points at work on the part's box.
  EXPECT_EQ(page["surface"]["frame"], "workpiece");
  const nlohmann::json& path = page["path"];
  ASSERT_GT(path["time_s"].size(), 50U);
  EXPECT_EQ(path["tool"]["kind"], "probe");
  EXPECT_EQ(path["tool"]["radius_mm"], 9);
  std::size_t at_work = 0;
  for (std::size_t i = 0; i < path["time_s"].size(); ++i) {
    if (path["working"][i] == 0) continue;
    ++at_work;
    for (std::size_t k = 0; k < 3; ++k) {
      const double low = page["surface"]["lower_mm"][k], at = path["point_mm"][std::string(1, "xyz"[k])][i];
      EXPECT_GE(at, low - 1e-3);
      EXPECT_LE(at, low + 65535 * page["surface"]["step_mm"].get<double>() + 1e-3);
    }
  }
  EXPECT_GT(at_work, 30U);
}

TEST_F(ScanPlanCommand, MarksWaysThatAreNotClearAndStopsTheProgramBeforeThem) {
  // Z ends 1.2 mm above the upper end of the part: too low to go from line to line.
  std::string text = folder.read(machine);
  const std::size_t z = text.find("[axis.Z]\ntravel_mm = [-100, 100]");
  ASSERT_NE(z, std::string::npos);
  text.replace(text.find("100]", z), 4, "11.2]");
  folder.write("low.machine.toml", text);
  const std::vector<std::string> command{"scan",       "plan",     pyramid,        "--machine", "low.machine.toml",
                                         "--along-mm", "2",        "--between-mm", "2",         "--force",
                                         "-o",         "path.csv", "--program",    "path.ngc"};
  const CommandResult words = abbe(command);
  EXPECT_EQ(words.exit_code, ExitCode::computation_says_no) << words.err;
  EXPECT_NE(words.out.find("0 places not reached"), std::string::npos) << words.out;
  EXPECT_NE(words.out.find(" ways between lines are not clear: the probe may touch"), std::string::npos) << words.out;

  std::vector<std::string> with_json = command;
  with_json.emplace_back("--json");
  const CommandResult result = abbe(with_json);
  EXPECT_EQ(result.exit_code, ExitCode::computation_says_no) << result.err;
  const auto blocked_links = nlohmann::json::parse(result.out)["blocked_links"].get<std::size_t>();
  EXPECT_GT(blocked_links, 0U);

  // Row by row: the program stops right before the first move of each such way, and nowhere else.
  const std::vector<Block> blocks = blocks_of(folder.read("path.ngc"));
  std::istringstream path(folder.read("path.csv"));
  std::string line;
  std::getline(path, line);
  ASSERT_EQ(line.substr(0, 51), "time_s,C_deg,A_deg,X_mm,Y_mm,Z_mm,measures,blocked,");
  std::size_t at = 0, stops = 0;
  bool measured_before = true;
  while (std::getline(path, line)) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream fields(line);
    double number = 0;
    for (int i = 0; i < 6; ++i) fields >> number;
    int measures = 0, blocked = 0;
    fields >> measures >> blocked;
    bool stopped = false;
    for (; at < blocks.size() && blocks[at].words.count('X') == 0; ++at) {
      stopped = stopped || (blocks[at].words.count('M') == 1 && blocks[at].words.at('M') == 0);
    }
    ASSERT_LT(at++, blocks.size());
    EXPECT_EQ(stopped, blocked == 1 && measured_before) << line;
    stops += stopped ? 1U : 0U;
    measured_before = measures == 1;
  }
  EXPECT_EQ(stops, blocked_links);
}

TEST_F(ScanPlanCommand, AsksForWordsOfAxesWithNumbersAndForPlanesThatLeaveSomething) {
  CommandResult result =
      abbe({"scan", "plan", pyramid, "--machine", machine, "--beyond-plane-mm", "0", "1", "0", "50"});
  EXPECT_EQ(result.exit_code, ExitCode::bad_input);
  EXPECT_NE(result.err.find("--beyond-plane-mm"), std::string::npos) << result.err;
  result = abbe({"scan", "plan", pyramid, "--machine", machine, "--word", "W=C"});
  EXPECT_EQ(result.exit_code, ExitCode::bad_input);
  EXPECT_NE(result.err.find("--word W=C"), std::string::npos) << result.err;
}

TEST_F(ScanPlanCommand, RefusesWordsThatAProgramWouldMistake) {
  const auto refused = [&](const std::vector<std::string>& words, const std::string& why) {
    std::vector<std::string> command{"scan", "plan",         pyramid, "--machine", machine,   "--along-mm",
                                     "2",    "--between-mm", "2",     "--program", "path.ngc"};
    for (const std::string& word : words) command.insert(command.end(), {"--word", word});
    const CommandResult result = abbe(command);
    EXPECT_EQ(result.exit_code, ExitCode::bad_input) << result.out;
    EXPECT_NE(result.err.find(why), std::string::npos) << result.err;
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "path.ngc"));
  };
  refused({"C=A"}, "two axes have the word A");
  refused({"C=U", "A=U"}, "two axes have the word U");
  refused({"C="}, "--word C=: not an axis of this machine and its word");
  refused({"C=F"}, "--word C=F: no word of an axis");
  refused({"C=C1"}, "--word C=C1: no word of an axis");
  refused({"C=U", "C=V"}, "--word C=V: this axis has a word already");
}

/// A block as OBJ text. @param first  number of vertices written before
std::string block_obj(double low, double high, int first) {
  std::ostringstream text;
  for (int i = 0; i < 8; ++i) {
    text << "v " << ((i & 1) != 0 ? high : low) << ' ' << ((i & 2) != 0 ? high : low) << ' '
         << ((i & 4) != 0 ? high : low) << '\n';
  }
  for (const char* quad : {"1 3 4 2", "5 6 8 7", "1 2 6 5", "3 7 8 4", "1 5 7 3", "2 4 8 6"}) {
    std::istringstream corners(quad);
    text << 'f';
    for (int corner = 0; corners >> corner;) text << ' ' << first + corner;
    text << '\n';
  }
  return text.str();
}

TEST_F(ScanPlanCommand, CountsThePointsOfWhatIsWantedOnly) {
  // 60,000 mm2 that nobody asks for, and a cube of 1 mm above them.
  folder.write("blocks.obj", block_obj(-100, 0, 0) + block_obj(20, 21, 8));
  std::vector<std::string> command{"scan",       "plan", "blocks.obj",   "--machine", machine,
                                   "--along-mm", "0.1",  "--between-mm", "0.1",       "--json"};
  const CommandResult all = abbe(command);
  EXPECT_EQ(all.exit_code, ExitCode::bad_input) << all.out;
  EXPECT_NE(all.err.find("--along-mm: 6000600 points; expected at most 5,000,000"), std::string::npos) << all.err;
  command.insert(command.end(), {"--beyond-plane-mm", "0", "2", "0", "30"});  // y >= 15
  const CommandResult small = abbe(command);
  ASSERT_NE(small.exit_code, ExitCode::bad_input) << small.err;
  const nlohmann::json json = nlohmann::json::parse(small.out);
  EXPECT_NEAR(json["area_mm2"].get<double>(), 6, 1e-6);
  EXPECT_GT(json["points"].get<int>(), 400);
  EXPECT_TRUE(small.out.ends_with("}\n") && !small.out.ends_with("\n\n"));
}

TEST_F(ScanPlanCommand, RefusesAnglesOutOfTheirRangeWithTheirUnit) {
  const auto refused = [&](const std::string& option, const std::string& value, const std::string& why) {
    const CommandResult result = abbe({"scan", "plan", pyramid, "--machine", machine, option, value});
    EXPECT_EQ(result.exit_code, ExitCode::bad_input) << result.out;
    EXPECT_NE((result.out + result.err).find(why), std::string::npos) << result.err;
  };
  refused("--largest-angle-deg", "86", "--largest-angle-deg: 86 is not a number from 2 to 85 deg");
  refused("--crease-deg", "0.5", "--crease-deg: 0.5 is not a number from 1 to 90 deg");
  refused("--range-um", "-400", "-400 is not a number from 1e-09 to 1000000 um");
  refused("--linear-speed-mm-per-s", "nan", "nan is not a number from 1e-09 to 1000000 mm-per-s");
}

TEST_F(ScanPlanCommand, SaysWhatItDoesNotReach) {
  // The probe is as thick as the part is long, and the part stands on a plate.
  folder.write("plate.obj", "v -60 -20.1 -60\nv 60 -20.1 -60\nv 60 -20.1 60\nv -60 -20.1 60\nf 1 4 3\nf 1 3 2\n");
  const CommandResult result = abbe({"scan", "plan", pyramid, "--machine", machine, "--stage", "plate.obj",
                                     "--along-mm", "2", "--between-mm", "2", "--probe-radius-mm", "15", "--json"});
  EXPECT_EQ(result.exit_code, ExitCode::computation_says_no) << result.err;
  const nlohmann::json json = nlohmann::json::parse(result.out);
  EXPECT_GT(json["missed"].get<int>(), 10);
  EXPECT_LT(json["covered_percent"].get<double>(), 95.0);
}

TEST_F(ScanPlanCommand, RefusesAnOpenMesh) {
  folder.write("open.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const CommandResult result = abbe({"scan", "plan", "open.obj", "--machine", machine});
  EXPECT_EQ(result.exit_code, ExitCode::bad_input);
  EXPECT_NE(result.err.find("open.obj"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("not closed"), std::string::npos) << result.err;
}

}  // namespace
}  // namespace abbe
