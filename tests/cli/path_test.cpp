#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cli/command_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;
using CsvRow = std::map<std::string, std::string>;

std::vector<CsvRow> csv_rows(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::vector<std::string> columns;
  std::vector<CsvRow> rows;
  for (std::string line; std::getline(file, line);) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.empty() || line[0] == '#') continue;
    std::istringstream cells(line);
    std::vector<std::string> values;
    for (std::string cell; std::getline(cells, cell, ',');) values.push_back(cell);
    if (columns.empty()) {
      columns = values;
      continue;
    }
    CsvRow row;
    for (std::size_t i = 0; i < columns.size(); ++i) row[columns[i]] = values.at(i);
    rows.push_back(row);
  }
  return rows;
}

double number(const CsvRow& row, const std::string& column) { return std::stod(row.at(column)); }

class Path : public CommandTest {
 protected:
  const std::filesystem::path source = ABBE_SOURCE_DIR;
  const std::string u_machine = (source / "examples/machines/yin-engraver-u.machine.toml").string();
  const std::string a4 = (source / "examples/laser_engraver/table-a4.csv").string();
  const std::string placement = (source / "examples/laser_engraver/part.placement.toml").string();

  void write(const std::string& name, const std::string& text) const { std::ofstream(folder.path() / name) << text; }
  std::string text_of(const std::string& name) const {
    std::ifstream file(folder.path() / name);
    return {std::istreambuf_iterator<char>(file), {}};
  }
};

TEST_F(Path, TableA4EqualsTheReferenceInBothConventionsReadingsBranchesAndTableAngles) {
  const std::vector<CsvRow> reference = csv_rows(source / "tests/golden/yin/p0_A4_chain.csv");
  // In P the printed Z+ of the beam points inwards.
  std::string inward = "x_mm,y_mm,z_mm,i,j,k,feed_mm_per_min\n";
  for (const CsvRow& row : csv_rows(a4)) {
    inward += row.at("x_mm") + "," + row.at("y_mm") + "," + row.at("z_mm");
    for (const char* c : {"i", "j", "k"}) {
      std::ostringstream value;
      value.precision(17);
      value << -number(row, c);
      inward += "," + value.str();
    }
    inward += ",600\n";
  }
  write("inward.csv", inward);
  write("other.placement.toml",
        "maps = \"workpiece-to-table\"\ntranslation_mm = [-73.896, 94.924, 33.385]\nangles_deg = [-0.103, -0.034, "
        "-0.097]\n");
  int compared = 0;
  for (const char* convention : {"U", "P"}) {
    const bool u = convention[0] == 'U';
    const std::string machine =
        (source / "examples/machines" / (u ? "yin-engraver-u.machine.toml" : "yin-engraver-p.machine.toml")).string();
    for (const char* reading : {"DBW", "DWB"}) {
      for (const std::string c2 : {"0", "30"}) {
        for (const char* branch : {"pos_", "neg_"}) {
          const auto first = std::find_if(reference.begin(), reference.end(), [&](const CsvRow& row) {
            return row.at("conv") == convention && row.at("eq8_means") == reading &&
                   number(row, "C2_deg") == std::stod(c2);
          });
          ASSERT_NE(first, reference.end());
          std::vector<std::string> arguments = {
              "path",   u ? a4 : "inward.csv", "--machine",
              machine,  "--placement",         reading[1] == 'B' ? placement : "other.placement.toml",
              "--hold", "C2_deg=" + c2,        "--force",
              "-o",     "commands.csv"};
          for (const char* axis : {"X", "Y", "Z", "A_deg", "C1_deg"}) {
            const std::string unit = axis[1] == 0 ? "_mm" : "";
            arguments.insert(arguments.end(), {"--start", axis + unit + "=" + first->at(std::string(branch) + axis)});
          }
          const CommandResult result = abbe(arguments);
          ASSERT_EQ(result.exit_code, ExitCode::done) << result.err;
          const std::vector<CsvRow> ours = csv_rows(folder.path() / "commands.csv");
          ASSERT_EQ(ours.size(), 30U);
          for (const CsvRow& row : reference) {
            if (row.at("conv") != convention || row.at("eq8_means") != reading ||
                number(row, "C2_deg") != std::stod(c2)) {
              continue;
            }
            const CsvRow& found = ours.at(static_cast<std::size_t>(number(row, "point")) - 1);
            for (const char* axis : {"X", "Y", "Z"}) {
              EXPECT_NEAR(number(found, std::string(axis) + "_mm"), number(row, branch + std::string(axis)), 1e-9);
            }
            for (const char* axis : {"A", "C1"}) {
              const double difference =
                  number(found, std::string(axis) + "_deg") - number(row, branch + std::string(axis) + "_deg");
              EXPECT_NEAR(std::remainder(difference, 360), 0, 1e-11) << axis;
            }
            ++compared;
          }
        }
      }
    }
  }
  EXPECT_EQ(compared, 240);
}

TEST_F(Path, WarningsOfThePlacementAreRepeated) {
  std::ifstream file(placement);
  write("part.placement.toml", std::string(std::istreambuf_iterator<char>(file), {}) +
                                   "warnings = [\"the part is incomplete: 1 face is left out\"]\n");
  const CommandResult result = abbe(
      {"path", a4, "--machine", u_machine, "--placement", "part.placement.toml", "--report", "page.html", "--json"});
  EXPECT_EQ(result.exit_code, ExitCode::done) << result.err;
  EXPECT_EQ(result.err, "abbe: warning: part.placement.toml: the part is incomplete: 1 face is left out\n");
  EXPECT_EQ(nlohmann::json::parse(result.out).at("warnings").at(0), "the part is incomplete: 1 face is left out");
  EXPECT_THAT(text_of("page.html"), HasSubstr("part.placement.toml; the part is incomplete"));
}

TEST_F(Path, ProgramBringsTheToolAlongTheCurveWithItsFeedAndPierce) {
  const CommandResult result =
      abbe({"path", a4, "--machine", u_machine, "--placement", placement, "--tolerance-um", "1", "--decimals", "9",
            "--word", "C1=C", "--word", "C2=B", "-o", "part.ngc", "-o", "part.csv", "--json"});
  ASSERT_EQ(result.exit_code, ExitCode::done) << result.err;
  const nlohmann::json json = nlohmann::json::parse(result.out);
  EXPECT_LE(json["largest_deviation_um"].get<double>(), 1);
  EXPECT_LT(json["largest_miss_mm"].get<double>(), 1e-9);
  const std::vector<CsvRow> steps = csv_rows(folder.path() / "part.csv");
  EXPECT_EQ(steps.size(), 30 + json["inserted"].get<std::size_t>());
  // The program says the same as the table of commands: every block in turn, words that stay left out.
  std::istringstream program(text_of("part.ngc"));
  std::map<char, double> now;
  std::size_t step = 0;
  double minutes = 0;
  for (std::string line; std::getline(program, line);) {
    if (!line.starts_with("G0 ") && !line.starts_with("G1 ")) continue;
    std::istringstream words(line.substr(3));
    for (std::string word; words >> word;) now[word[0]] = std::stod(word.substr(1));
    ASSERT_LT(step, steps.size());
    for (const auto& [letter, column] : std::map<char, std::string>{
             {'X', "X_mm"}, {'Y', "Y_mm"}, {'Z', "Z_mm"}, {'A', "A_deg"}, {'B', "C2_deg"}, {'C', "C1_deg"}}) {
      EXPECT_NEAR(now[letter], number(steps[step], column), 1e-8) << line;
    }
    if (line.starts_with("G1 ")) minutes += 1 / now['F'];
    ++step;
  }
  EXPECT_EQ(step, steps.size());
  EXPECT_NEAR(minutes, json["length_mm"].get<double>() / 600, 1e-4);
  EXPECT_THAT(text_of("part.ngc"), HasSubstr("M3\nG4 P0.200\nG93\n"));
}

TEST_F(Path, RegionsAndIdentifiedErrorsChangeTheCommands) {
  const std::string curve = (source / "examples/laser_engraver/regions.ngc").string();
  const std::string errors = (source / "examples/laser_engraver/linkage.errors.toml").string();
  const CommandResult without = abbe({"path", curve, "--machine", u_machine});
  EXPECT_EQ(without.exit_code, ExitCode::bad_input);
  EXPECT_THAT(without.err, HasSubstr("--retract-mm"));
  ASSERT_EQ(abbe({"path", curve, "--machine", u_machine, "--retract-mm", "20", "-o", "nominal.csv"}).exit_code,
            ExitCode::done);
  const CommandResult result = abbe({"path", curve, "--machine", u_machine, "--errors", errors, "--retract-mm", "20",
                                     "-o", "true.csv", "-o", "true.mpf"});
  ASSERT_EQ(result.exit_code, ExitCode::done) << result.err;
  EXPECT_THAT(result.out, HasSubstr("2 regions"));
  const std::vector<CsvRow> nominal = csv_rows(folder.path() / "nominal.csv"),
                            corrected = csv_rows(folder.path() / "true.csv");
  ASSERT_EQ(nominal.size(), 34U);
  ASSERT_EQ(corrected.size(), 34U);
  EXPECT_EQ(number(corrected[20], "C2_deg"), 12);
  // C1 is half a turn from its zero: its axis displaced by 22 um moves the focus by 44, R_C1 longer by 25 um moves it
  // back.
  EXPECT_NEAR(number(corrected[3], "X_mm") - number(nominal[3], "X_mm"), 0.019, 1e-3);
  EXPECT_THAT(text_of("true.mpf"), HasSubstr("C2=12.000000"));
}

TEST_F(Path, TheStartCountsByTheAxesThatItNames) {
  const std::vector<CsvRow> reference = csv_rows(source / "tests/golden/yin/p0_A4_chain.csv");
  const auto row = std::find_if(reference.begin(), reference.end(), [](const CsvRow& at) {
    return at.at("conv") == "U" && at.at("eq8_means") == "DBW" && number(at, "C2_deg") == 0;
  });
  ASSERT_NE(row, reference.end());
  const std::vector<std::string> path = {"path",   a4,         "--machine", u_machine, "--placement", placement,
                                         "--hold", "C2_deg=0", "-o",        "out.csv", "--force"};
  for (const std::string branch : {"pos_", "neg_"}) {
    for (const std::string axis : {"A_deg", "C1_deg"}) {
      std::vector<std::string> arguments = path;
      arguments.insert(arguments.end(), {"--start", axis + "=" + row->at(branch + axis)});
      const CommandResult result = abbe(arguments);
      ASSERT_EQ(result.exit_code, ExitCode::done) << result.err;
      EXPECT_NEAR(number(csv_rows(folder.path() / "out.csv").at(0), "A_deg"), number(*row, branch + "A_deg"), 1e-9)
          << branch << axis;
    }
  }
  // Both branches tilt by the same amount to either side.
  std::vector<std::string> arguments = path;
  arguments.insert(arguments.end(), {"--start", "A_deg=0"});
  const CommandResult result = abbe(arguments);
  EXPECT_EQ(result.exit_code, ExitCode::bad_input);
  EXPECT_THAT(result.err, HasSubstr("--start: the start does not decide between the branches: it needs a command of"));
  EXPECT_THAT(result.err, HasSubstr("C1"));
}

TEST_F(Path, WhatCannotBeDoneIsSaid) {
  write("curve.csv", "x_mm,y_mm,z_mm,i,j,k\n0,0,0,0,0,1\n5000,0,0,0,0,1\n");
  const CommandResult feed = abbe({"path", "curve.csv", "--machine", u_machine});
  EXPECT_EQ(feed.exit_code, ExitCode::bad_input);
  EXPECT_THAT(feed.err, HasSubstr("--feed-mm-per-min"));
  const CommandResult travel =
      abbe({"path", "curve.csv", "--machine", u_machine, "--feed-mm-per-min", "100", "-o", "out.ngc"});
  EXPECT_EQ(travel.exit_code, ExitCode::computation_says_no);
  EXPECT_THAT(travel.err, HasSubstr("point 2"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "out.ngc"));
  const CommandResult hold = abbe({"path", a4, "--machine", u_machine, "--hold", "Q_deg=1"});
  EXPECT_EQ(hold.exit_code, ExitCode::bad_input);
  EXPECT_THAT(hold.err, HasSubstr("no axis 'Q'"));
  const CommandResult kind = abbe({"path", a4, "--machine", u_machine, "-o", "out.txt"});
  EXPECT_EQ(kind.exit_code, ExitCode::bad_input);
  const CommandResult words =
      abbe({"path", a4, "--machine", u_machine, "--word", "C1=C", "--word", "C2=C", "-o", "out.ngc"});
  EXPECT_EQ(words.exit_code, ExitCode::bad_input);
  EXPECT_THAT(words.err, HasSubstr("two axes have the word C"));
}

}  // namespace
}  // namespace abbe
