// abbe import: tables of other programs, and what abbe does with what they become.
#include <gmock/gmock.h>

#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "abbe/formats/import/gzip_for_test.h"
#include "cli/command_test.h"
#include "cli/machine_for_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;
using testing::Not;

const std::string kExamples = ABBE_SOURCE_DIR "/examples/";
const std::string kMill = kExamples + "machines/three-axis-mill.machine.toml";

class Import : public CommandTest {
 protected:
  /// Imports a file of these bytes to out.csv. @returns its contents
  std::string imported(const std::string& bytes, std::vector<std::string> options = {},
                       int expected_exit = ExitCode::done) const {
    folder.write("table.txt", bytes);
    options.insert(options.begin(), {"import", "table.txt", "-o", "out.csv", "--force"});
    const CommandResult result = abbe(options);
    EXPECT_EQ(result.exit_code, expected_exit) << result.out << result.err;
    return result.exit_code == ExitCode::done ? folder.read("out.csv") : "";
  }
  void expect_refused(const std::string& bytes, const std::vector<std::string>& options,
                      const std::string& message) const {
    folder.write("table.txt", bytes);
    std::vector<std::string> arguments = {"import", "table.txt", "-o", "refused.csv"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const CommandResult result = abbe(arguments);
    EXPECT_EQ(result.exit_code, ExitCode::bad_input) << result.out;
    EXPECT_EQ(result.out, "");
    EXPECT_THAT(result.err, HasSubstr(message));
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "refused.csv"));
  }
};

TEST_F(Import, SemicolonsDecimalCommasLatin1AndARowOfUnits) {
  EXPECT_EQ(
      imported("Me\xDFger\xE4t 7\r\n\r\nPunkt;X;Y;Z\r\n;mm;mm;\xB5m\r\nA1;1,50;-2;3000,5\r\n\"a;b\";4;5,25;6\r\n"),
      "point,x_mm,y_mm,z_um\nA1,1.50,-2,3000.5\na;b,4,5.25,6\n");
}

TEST_F(Import, Utf16WithTabs) {
  const std::string table = "Name\tX [mm]\tY [mm]\tZ [mm]\r\np 1\t1.5\t2\t3\r\n";
  const std::string csv = "point,x_mm,y_mm,z_mm\np 1,1.5,2,3\n";
  EXPECT_EQ(imported("\xFF\xFE" + test::utf16_of(table, false)), csv);
  EXPECT_EQ(imported("\xFE\xFF" + test::utf16_of(table, true)), csv);
}

TEST_F(Import, InchesAndThousands) {
  EXPECT_EQ(imported("x(in),y(in),z(in)\n\"1,234.5\",2,0.001\n", {"--as", "points"}),
            "x_mm,y_mm,z_mm\n31356.30,50.8,0.0254\n");
  EXPECT_EQ(imported("x(mm);y(mm);z(mm)\n1.234,5;2;3\n", {}), "x_mm,y_mm,z_mm\n1234.5,2,3\n");
  EXPECT_EQ(imported("x(mm);y(mm);z(mm)\n1'234.5;2;3\n", {}), "x_mm,y_mm,z_mm\n1234.5,2,3\n");
}

TEST_F(Import, PointNamesAreKeptToTheEnd) {
  std::string table = "Punkt\tx [mm]\ty [mm]\tz [mm]\n";
  for (const char* const row : {"Norden\t0,5\t10,5\t0\n", "Osten\t10,5\t0,5\t0\n",
                                "S\xFC"
                                "den\t0,5\t-9,5\t0\n",
                                "\"West, unten\"\t-9,5\t0,5\t0\n"}) {
    table += row;
  }
  imported(table);
  const CommandResult fit = abbe({"fit", "out.csv", "--shape", "circle2", "--residuals", "residuals.csv"});
  EXPECT_EQ(fit.exit_code, ExitCode::done) << fit.err;
  const std::string residuals = folder.read("residuals.csv");
  EXPECT_THAT(residuals, HasSubstr("x_mm,y_mm,z_mm,deviation_mm,point\n"));
  EXPECT_THAT(residuals, HasSubstr(",Süden\n"));
  EXPECT_THAT(residuals, HasSubstr(",\"West, unten\"\n"));
}

TEST_F(Import, ZenithAndClockwiseAnglesOfATotalStation) {
  const CommandResult result = abbe({"import", kExamples + "import/total-station.txt", "--machine", kMill, "-o",
                                     "r.csv", "--write-mapping", "m.import.toml"});
  EXPECT_EQ(result.exit_code, ExitCode::done) << result.err;
  EXPECT_THAT(result.out, HasSubstr("windows-1252"));
  EXPECT_THAT(result.out, HasSubstr("the nominal machine fits to 0.01"));
  EXPECT_THAT(result.out, HasSubstr("from the zenith: range 110.119 to 129.312"));
  // In a study the tracker stands where the angles say: a wrong sense or origin would leave decimetres.
  folder.write("s.study.toml", "machine = \"" + kMill + R"("
output = "out"
[[setup]]
name = "station"
instrument = "tracker"
noise = { xyz_um = 20 }
[[setup.reflector]]
name = "R"
offset_mm = [0, 0, -120]
[[setup.data]]
file = "r.csv"
[identify]
[[identify.motion]]
errors = "EXX"
basis = "legendre"
order = 1
)");
  const CommandResult run = abbe({"run", "s.study.toml"});
  ASSERT_NE(run.exit_code, ExitCode::bad_input) << run.err;
  const auto summary = nlohmann::json::parse(folder.read("out/summary.json"));
  EXPECT_LT(summary.at("fit_residual_um").at("max").get<double>(), 60);
  EXPECT_THAT(folder.read("out/residuals.csv"), HasSubstr(",P12,"));

  // The mapping makes it repeatable, byte by byte; from a pipe and from gzip too.
  EXPECT_EQ(abbe({"import", kExamples + "import/total-station.txt", "--machine", kMill, "-o", "again.csv", "--mapping",
                  "m.import.toml"})
                .exit_code,
            ExitCode::done);
  EXPECT_EQ(folder.read("again.csv"), folder.read("r.csv"));
}

TEST_F(Import, AMachineTellsALeftHandedFrameAndTheOrderOfColumns) {
  folder.write("m.toml", kTableXColumnZ);
  // The machine has X and Z only: its points are in a plane, and a mirrored frame fits as well.
  const std::string flat =
      "X_mm,Z_mm,x[mm],y[mm],z[mm]\n0,0,10.5,20,30\n100,0,110.5,20,30\n0,100,10.5,20,130\n"
      "50,70,60.5,20,100\n";
  EXPECT_THAT(imported(flat, {"--machine", "m.toml"}), HasSubstr("0,0,10.5,20,30\n"));
  std::string left = "# no names\n", columns;
  for (const char* const row : {"0 0 0", "700 0 -10", "0 400 -20", "100 50 -400", "350 200 -200", "600 300 -300"}) {
    int x = 0, y = 0, z = 0;
    ASSERT_EQ(std::sscanf(row, "%d %d %d", &x, &y, &z), 3);
    left += std::string(row) + " " + std::to_string(x + 5) + ".5 " + std::to_string(-y - 7) + " " +
            std::to_string(z + 90) + "\n";
  }
  EXPECT_THAT(imported(left, {"--machine", kMill}), HasSubstr("\n700,0,-10,705.5,7,80\n"));
  const CommandResult shown = abbe({"import", "table.txt", "--machine", kMill});
  EXPECT_THAT(shown.out, HasSubstr("reversed: by its place;\n                   the nominal machine fits to"));
  // Which coordinate is reversed is a matter of taste; whether one is, is not.
  EXPECT_THAT(imported(left, {"--machine", kMill, "--mirrored", "x"}), HasSubstr("\n700,0,-10,-705.5,-7,80\n"));
  std::string right = "X_mm Y_mm Z_mm x_mm y_mm z_mm\n0 0 0 5 7 90\n";
  right += "700 0 -10 705 7 80\n0 400 -20 5 407 70\n100 50 -400 105 57 -310\n";
  folder.write("right.txt", right);
  const CommandResult wrong = abbe({"import", "right.txt", "--machine", kMill, "--mirrored", "y"});
  EXPECT_EQ(wrong.exit_code, ExitCode::computation_says_no) << wrong.out;
  EXPECT_THAT(wrong.out, HasSubstr("only with it reversed"));
  EXPECT_EQ(abbe({"import", "right.txt", "--machine", kMill}).exit_code, ExitCode::done);
}

TEST_F(Import, GzipAndStandardInput) {
  const std::string table = "x_mm;y_mm;z_mm\n1,5;2;3\n", csv = "x_mm,y_mm,z_mm\n1.5,2,3\n";
  EXPECT_EQ(imported(test::gzip_of(table)), csv);
  folder.write("t.gz", test::gzip_of(table));
  const CommandResult piped =
      run_program("/bin/sh", {"-c", "cat t.gz | " ABBE_COMMAND " import - -o piped.csv"}, folder.path());
  EXPECT_EQ(piped.exit_code, ExitCode::done) << piped.err;
  EXPECT_EQ(folder.read("piped.csv"), csv);
  EXPECT_THAT(piped.out, HasSubstr("<stdin>: gzip, utf-8"));
  const std::string packed = test::gzip_of(table);
  expect_refused(packed.substr(0, packed.size() - 3), {}, "table.txt: the compressed data are cut short");
}

TEST_F(Import, PositioningIsEvaluated) {
  const CommandResult result = abbe({"import", kExamples + "import/positioning.csv", "-o", "p.csv"});
  EXPECT_EQ(result.exit_code, ExitCode::done) << result.err;
  EXPECT_THAT(result.out, HasSubstr("read as positioning"));
  EXPECT_THAT(result.out, HasSubstr("50 rows"));
  const CommandResult evaluated = abbe({"evaluate", "positioning", "p.csv", "--json"});
  ASSERT_EQ(evaluated.exit_code, ExitCode::done) << evaluated.err;
  const auto figures = nlohmann::json::parse(evaluated.out).at("figures");
  // The example has a reversal of 1.8 um.
  EXPECT_NEAR(figures.at("B_mean").at("value_um").get<double>(), 1.8, 0.2);
}

TEST_F(Import, WhatIsUncertainIsNotWrittenUntilItIsConfirmed) {
  const std::string table = "x,y,z\n1.5,2,3\n";
  EXPECT_EQ(imported(table, {"--write-mapping", "m.import.toml"}, ExitCode::computation_says_no), "");
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "out.csv"));
  EXPECT_THAT(folder.read("m.import.toml"), HasSubstr("# UNCERTAIN: states no unit; millimetres are assumed"));
  const CommandResult told = abbe({"import", "table.txt", "-o", "out.csv"});
  EXPECT_THAT(told.out,
              HasSubstr("UNCERTAIN: states no unit; millimetres are assumed (range 1.5 to 1.5; --length-unit)"));
  EXPECT_THAT(told.err, HasSubstr("out.csv is not written; what is uncertain has to be confirmed"));
  const std::string csv = "x_mm,y_mm,z_mm\n1.5,2,3\n";
  EXPECT_EQ(imported(table, {"--mapping", "m.import.toml"}), csv);
  EXPECT_EQ(imported(table, {"--accept-uncertain"}), csv);
  EXPECT_EQ(imported(table, {"--length-unit", "mm"}), csv);
  EXPECT_EQ(imported(table, {"--length-unit", "inch"}), "x_mm,y_mm,z_mm\n38.10,50.8,76.2\n");
}

TEST_F(Import, SmallAndAmbiguousTables) {
  EXPECT_EQ(imported("x_mm y_mm z_mm\n1 2 3"), "x_mm,y_mm,z_mm\n1,2,3\n");
  expect_refused("", {}, "table.txt: the file is empty");
  expect_refused("\n\n", {}, "table.txt: the file is empty; expected a table of readings");
  expect_refused("x_mm,y_mm,z_mm\n", {}, "no table was found");
  expect_refused("x_mm;y_mm;z_mm\n1,234;2;3\n", {},
                 "table.txt:2:1: '1,234' in line 2 may have decimals or thousands, and the table does not show which; "
                 "expected --decimal point or --decimal comma");
  EXPECT_EQ(imported("x_mm;y_mm;z_mm\n1,234;2;3\n", {"--decimal", "comma"}), "x_mm,y_mm,z_mm\n1.234,2,3\n");
  EXPECT_EQ(imported("x_mm;y_mm;z_mm\n1,234;2;3\n", {"--decimal", "point"}), "x_mm,y_mm,z_mm\n1234,2,3\n");
  expect_refused("x_mm,y_mm,z_mm\n1.5,2,3\n4,5\n", {},
                 "table.txt:3:1: the row has 2 fields; expected 3 as in the header");
  expect_refused("x_mm,y_mm,z_mm\n1.5,2,3\n4,oops,6\n", {},
                 "table.txt:3:3: y_mm: 'oops' is not a number; expected a number with a decimal point");
  expect_refused("x_mm,y_mm,z_mm\n1.5,2,3\n", {"--as", "tracker"}, "--machine: is missing");
}

TEST_F(Import, ReadersOfAbbeSpeakWithTheLineOfTheTable) {
  folder.write("m.toml", kTableXColumnZ);
  expect_refused("remark\nX_mm;Z_mm;x_mm;y_mm;z_mm\n\n1,5;2;3;4;5\n1401;2;3;4;5\n", {"--machine", "m.toml"},
                 "table.txt:5: X_mm: 1401 mm is outside the travel of axis X; expected 0 to 1400 mm");
}

TEST_F(Import, OptionsBelongTogether) {
  folder.write("m.import.toml", "kind = \"points\"\n");
  expect_refused("x_mm,y_mm,z_mm\n1.5,2,3\n", {"--mapping", "m.import.toml"}, "m.import.toml:");
  const CommandResult both = abbe({"import", "table.txt", "--mapping", "m.import.toml", "--decimal", "comma"});
  EXPECT_EQ(both.exit_code, ExitCode::bad_input);
  EXPECT_THAT(both.err, HasSubstr("--mapping"));
  expect_refused("x_mm,y_mm,z_mm\n1.5,2,3\n", {"--azimuth", "clockwise"}, "--azimuth: the table has no azimuth");
}

TEST_F(Import, JsonSaysTheSame) {
  folder.write("table.txt", "# made by hand\nx [mm];y [mm];z [mm];Rest\n1,5;2;3;a\n\n# end\n");
  const CommandResult result = abbe({"import", "table.txt", "--json"});
  EXPECT_EQ(result.exit_code, ExitCode::done) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json.at("kind"), "points");
  EXPECT_EQ(json.at("layout").at("separator"), "semicolon");
  EXPECT_EQ(json.at("layout").at("header_line"), 2);
  EXPECT_EQ(json.at("layout").at("comment"), "#");
  EXPECT_EQ(json.at("columns").at(1).at("name"), "y_mm");
  EXPECT_EQ(json.at("columns").at(1).at("from"), "y [mm]");
  EXPECT_EQ(json.at("not_read").at(0), "column 4 'Rest'");
  EXPECT_EQ(json.at("rows"), 1);
  EXPECT_EQ(json.at("blank_lines"), 1);
  EXPECT_EQ(json.at("comment_lines"), 1);
  EXPECT_TRUE(json.at("certain").get<bool>());
}

}  // namespace
}  // namespace abbe
