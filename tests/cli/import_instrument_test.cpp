// abbe import of files of instruments, and what abbe does with what they become.
#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cli/command_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;
using testing::Not;

const std::string kSamples = ABBE_SOURCE_DIR "/examples/import/";

class ImportOfInstruments : public CommandTest {
 protected:
  CommandResult imported(const std::string& file, std::vector<std::string> options,
                         int expected_exit = ExitCode::done) const {
    options.insert(options.begin(), {"import", file});
    const CommandResult result = abbe(options);
    EXPECT_EQ(result.exit_code, expected_exit) << result.out << result.err;
    return result;
  }
  nlohmann::json evaluated(const std::vector<std::string>& arguments) const {
    const CommandResult result = abbe(arguments);
    EXPECT_EQ(result.exit_code, ExitCode::done) << result.err;
    return nlohmann::json::parse(result.out);
  }
};

TEST_F(ImportOfInstruments, RunsOfALaserAreEvaluatedAsTheSameReadingsOfATable) {
  const CommandResult result =
      imported(kSamples + "laser.rtl", {"--length-unit", "mm", "-o", "laser.csv", "--write-mapping", "m.import.toml"});
  EXPECT_THAT(result.out, HasSubstr("file of a Renishaw laser interferometer: HEADER:: in line 1, file type 'rtl'"));
  EXPECT_THAT(result.out, HasSubstr("read as positioning (what such a file holds)"));
  EXPECT_THAT(result.out, HasSubstr("stated: Air temp: 20.412356 20.498112 0\n"));
  EXPECT_THAT(result.out, HasSubstr("not read: Flags '0 0 2 0' but for the second"));
  EXPECT_THAT(result.out, HasSubstr("50 rows"));
  imported(kSamples + "positioning.csv", {"-o", "table.csv"});
  const nlohmann::json laser = evaluated({"evaluate", "positioning", "laser.csv", "--json"}).at("figures");
  EXPECT_EQ(laser, evaluated({"evaluate", "positioning", "table.csv", "--json"}).at("figures"));
  // By the definitions of ISO 230-2 from the readings of examples/import/positioning.csv, in Python.
  EXPECT_NEAR(laser.at("E").at("value_um").get<double>(), 6.92, 1e-9);
  EXPECT_NEAR(laser.at("B").at("value_um").get<double>(), 1.946, 1e-9);
  EXPECT_NEAR(laser.at("B_mean").at("value_um").get<double>(), 1.8064, 1e-9);
  EXPECT_NEAR(laser.at("R").at("value_um").get<double>(), 3.1301404460913442, 1e-9);
  EXPECT_NEAR(laser.at("A").at("value_um").get<double>(), 7.838117719916255, 1e-9);
  // The mapping reads it again, and in other units where it says so.
  imported(kSamples + "laser.rtl", {"--mapping", "m.import.toml", "-o", "again.csv"});
  EXPECT_EQ(folder.read("again.csv"), folder.read("laser.csv"));
  std::string mapping = folder.read("m.import.toml");
  EXPECT_THAT(mapping, HasSubstr("format = \"renishaw-laser\"\n"));
  EXPECT_THAT(mapping, Not(HasSubstr("[layout]")));
}

TEST_F(ImportOfInstruments, UnitsThatALaserDoesNotStateHaveToBeConfirmed) {
  const CommandResult result = imported(kSamples + "laser.rtl", {"-o", "laser.csv"}, ExitCode::computation_says_no);
  EXPECT_THAT(result.out, HasSubstr("UNCERTAIN: states no unit; mm is assumed"));
  EXPECT_THAT(result.err, HasSubstr("laser.csv is not written"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "laser.csv"));
  imported(kSamples + "laser.rtl", {"-o", "accepted.csv", "--accept-uncertain"});
  imported(kSamples + "laser.rtl", {"-o", "laser.csv", "--length-unit", "mm"});
  EXPECT_EQ(folder.read("accepted.csv"), folder.read("laser.csv"));
  folder.write("inch.import.toml",
               "kind = \"positioning\"\nformat = \"renishaw-laser\"\n[[column]]\nname = \"direction\"\n"
               "from = \"direction\"\n[[column]]\nname = \"target_mm\"\nfrom = \"Targets\"\nunit = \"inch\"\n"
               "[[column]]\nname = \"deviation_um\"\nfrom = \"Data\"\nunit = \"thou\"\n");
  const CommandResult inches = imported(kSamples + "laser.rtl", {"--mapping", "inch.import.toml", "-o", "inch.csv"});
  EXPECT_THAT(inches.out,
              HasSubstr("not read: Flags '0 0 2 0' but for the second, which tells runs from one side, Run"));
  EXPECT_THAT(folder.read("inch.csv"), HasSubstr("direction,target_mm,deviation_um\n+,127.0000000,26.9240\n"));
}

TEST_F(ImportOfInstruments, WithoutReadingsAreShownAndNotWritten) {
  const CommandResult bar = imported(kSamples + "ballbar.b5r", {"-o", "bar.csv"}, ExitCode::computation_says_no);
  EXPECT_THAT(bar.out, HasSubstr("\nno readings\nstated: test: XY 360 degrees 150 mm\nstated: plane: XY\n"));
  EXPECT_THAT(bar.out, HasSubstr("stated: AF_SQUARENESS: -14.2 um/m\n"));
  EXPECT_THAT(bar.out, HasSubstr("UNCERTAIN: where such a file has its readings is not publicly described"));
  EXPECT_THAT(bar.err, HasSubstr("bar.csv is not written; there are no readings"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "bar.csv"));
  const CommandResult devices = imported(kSamples + "devices.xml", {}, ExitCode::computation_says_no);
  EXPECT_THAT(devices.out, HasSubstr("stated: Rotary C: endless rotary axis, along or about (0, 0, 1), at (400, 250, "
                                     "-500) mm, carried by Linear X\n"));
  EXPECT_THAT(devices.out, HasSubstr("stated: chain: Linear Y, Linear X, Rotary C\nstated: chain: Linear Z\n"));
  const nlohmann::json json =
      nlohmann::json::parse(imported(kSamples + "devices.xml", {"--json"}, ExitCode::computation_says_no).out);
  EXPECT_EQ(json.at("rows"), 0);
  EXPECT_FALSE(json.at("certain").get<bool>());
  EXPECT_THAT(imported(kSamples + "devices.xml", {"--accept-uncertain", "-o", "a.csv"}, ExitCode::bad_input).err,
              HasSubstr("--accept-uncertain: there are no readings to be written"));
  EXPECT_THAT(imported(kSamples + "ballbar.b5r", {"--write-mapping", "a.import.toml"}, ExitCode::bad_input).err,
              HasSubstr("there are no readings, so there is no mapping"));
}

TEST_F(ImportOfInstruments, PositioningReadingsOfEcmcAreEvaluated) {
  const std::string sample = kSamples + "positioning-ecmc.dat";
  const CommandResult doubted = imported(sample, {"-o", "e.csv"}, ExitCode::computation_says_no);
  EXPECT_THAT(doubted.out, HasSubstr("UNCERTAIN: the description of the form calls FWD forward"));
  imported(sample, {"--accept-uncertain", "-o", "e.csv", "--write-mapping", "e.import.toml"});
  EXPECT_THAT(folder.read("e.csv"), HasSubstr("run,direction,target_mm,actual_mm\n1,+,-20,-20.000656\n"));
  const nlohmann::json figures = evaluated({"evaluate", "positioning", "e.csv", "--json"}).at("figures");
  // A reversal of 8 um and a slope of 20 um/m over 40 mm, with noise of 1 um in means of three.
  EXPECT_NEAR(figures.at("B").at("value_um").get<double>(), 8, 3);
  EXPECT_LT(figures.at("B_mean").at("value_um").get<double>(), 0);
  // The other way round by a mapping.
  std::string mapping = folder.read("e.import.toml");
  const std::string direction = "from = \"direction\"\n";
  ASSERT_NE(mapping.find(direction), std::string::npos) << mapping;
  mapping.insert(mapping.find(direction) + direction.size(), "positive = [\"-\"]\nnegative = [\"+\"]\n");
  folder.write("other.import.toml", mapping);
  imported(sample, {"--mapping", "other.import.toml", "-o", "other.csv"});
  const nlohmann::json other = evaluated({"evaluate", "positioning", "other.csv", "--json"}).at("figures");
  EXPECT_EQ(other.at("B_mean").at("value_um").get<double>(), -figures.at("B_mean").at("value_um").get<double>());
}

TEST_F(ImportOfInstruments, TemperaturesOfAnAgentAreASeries) {
  imported(kSamples + "streams.xml", {"--format", "mtconnect-temperatures", "-o", "t.csv"});
  EXPECT_EQ(folder.read("t.csv"), "time,sensor,temperature_degC\n2026-05-04T10:19:50.000Z,X Xtemp,22.5\n");
}

TEST_F(ImportOfInstruments, FilesOfKnownProgramsAreNamed) {
  folder.write("sa.txt", "// SA\nA::grp::p1 1.5 2 3\nA::grp::p2 4 5.5 6\nA::grp::p3 4 5 6\n");
  EXPECT_THAT(imported("sa.txt", {}, ExitCode::bad_input).err, HasSubstr("point list of SpatialAnalyzer"));
  EXPECT_THAT(imported("sa.txt", {"--as", "points", "--accept-uncertain", "-o", "sa.csv"}).out, HasSubstr("3 rows"));
  EXPECT_THAT(folder.read("sa.csv"), HasSubstr("A::grp::p2,4,5.5,6\n"));
  folder.write("log.txt", "SINUMERIK 840D sl\nmeasuring cycle CYCLE977\nno values\n");
  EXPECT_THAT(imported("log.txt", {}, ExitCode::bad_input).err, HasSubstr("protocol of measuring cycles of Siemens"));
}

TEST_F(ImportOfInstruments, ProbedPointsOfLinuxCncAreFitted) {
  const std::vector<std::string> sure = {"--format", "linuxcnc-probe", "--length-unit", "mm"};
  std::vector<std::string> options = sure;
  options.insert(options.end(), {"-o", "points.csv"});
  imported(kSamples + "probe-log.txt", options);
  const nlohmann::json fit = evaluated({"fit", "points.csv", "--shape", "circle2", "--json"});
  const std::string text = fit.dump();
  // Least squares by Gauss and Newton, in Python.
  EXPECT_THAT(text, HasSubstr("31.75044985"));
  EXPECT_THAT(text, HasSubstr("50.80143248"));
  EXPECT_THAT(text, HasSubstr("14.99955450"));
  // Nothing in the log tells that it is one, and in which unit.
  const CommandResult doubted = imported(kSamples + "probe-log.txt", {}, ExitCode::computation_says_no);
  EXPECT_THAT(doubted.out, HasSubstr("UNCERTAIN: it looks like a probe log of LinuxCNC"));
  EXPECT_THAT(doubted.out, HasSubstr("UNCERTAIN: a log is in the units of its program and states none"));
  // As a table it has columns without names.
  imported(kSamples + "probe-log.txt",
           {"--format", "table", "--as", "points", "--accept-uncertain", "-o", "table.csv"});
  EXPECT_EQ(folder.read("table.csv"), folder.read("points.csv"));
}

TEST_F(ImportOfInstruments, TheSamePointsInFourForms) {
  imported(kSamples + "results.qif", {"-o", "qif.csv"});
  imported(kSamples + "streams.xml", {"-o", "streams.csv"});
  imported(kSamples + "results.dmo", {"-o", "dmis.csv"});
  const CommandResult tab = imported(kSamples + "points.tab", {"-o", "tab.csv", "--write-mapping", "tab.import.toml"});
  EXPECT_THAT(tab.out, HasSubstr("table of a Heidenhain control: BEGIN FLANGE.TAB MM in line 1"));
  EXPECT_THAT(tab.out, HasSubstr("not read: description of the columns, lines 2 to 19, columns DOC"));
  EXPECT_THAT(folder.read("tab.csv"), HasSubstr("point,x_mm,y_mm,z_mm\n0,20.0003,0.0001,5.0021\n"));
  imported(kSamples + "points.tab", {"--mapping", "tab.import.toml", "-o", "tab-again.csv"});
  EXPECT_EQ(folder.read("tab-again.csv"), folder.read("tab.csv"));
  EXPECT_THAT(folder.read("qif.csv"), HasSubstr("point,x_mm,y_mm,z_mm\nP1,20.0003,0.0001,5.0021\n"));
  EXPECT_THAT(folder.read("dmis.csv"), HasSubstr("point,x_mm,y_mm,z_mm,nx,ny,nz\nP1,20.0003,0.0001,5.0021,0,0,1\n"));
  for (const char* const file : {"qif.csv", "streams.csv", "dmis.csv", "tab.csv"}) {
    const nlohmann::json figures = evaluated({"fit", file, "--shape", "plane", "--json"}).at("figures");
    // Least squares of z by the normal equations, in Python; the slopes are too small to make a difference.
    EXPECT_NEAR(figures.at("form").at("value_um").get<double>(), 2.0333235, 1e-6) << file;
    EXPECT_NEAR(figures.at("z").at("value_mm").get<double>(), 5.000333333, 1e-8) << file;
    EXPECT_NEAR(figures.at("direction_y").at("value").get<double>(), -6.7839e-5, 1e-8) << file;
  }
}

TEST_F(ImportOfInstruments, RefusesOptionsAndKindsThatAreOfNoUse) {
  const auto refused = [&](const std::vector<std::string>& options, const std::string& message) {
    const CommandResult result = imported(kSamples + "laser.rtl", options, ExitCode::bad_input);
    EXPECT_THAT(result.err, HasSubstr(message));
    EXPECT_EQ(result.out, "");
  };
  refused({"--separator", "tab"}, "--separator: is of no use for a file of a Renishaw laser interferometer");
  refused({"--decimal", "comma"}, "--decimal: is of no use");
  refused({"--azimuth", "clockwise"}, "--azimuth: is of no use");
  refused({"--vertical", "zenith"}, "--vertical: is of no use");
  refused({"--machine", ABBE_SOURCE_DIR "/examples/machines/three-axis-mill.machine.toml"}, "--machine: is of no use");
  refused({"--mirrored", "y"}, "--mirrored: the file has no such coordinate");
  refused({"--as", "points"},
          "--as: a file of a Renishaw laser interferometer does not become points; expected positioning");
  refused({"--format", "dmis"}, "FEAT: there are no points");
  refused({"--format", "laser"}, "--format");
}

TEST_F(ImportOfInstruments, OfALeftHandedFrameAreReversed) {
  imported(kSamples + "results.dmo", {"--mirrored", "z", "-o", "mirrored.csv"});
  EXPECT_THAT(folder.read("mirrored.csv"), HasSubstr("\nP2,-10.0002,17.3206,-5.0013,0,0,-1\n"));
}

TEST_F(ImportOfInstruments, SpeaksWithTheLineOfTheFile) {
  std::string text = folder.read(kSamples + "results.dmo");
  const std::string vector = "20.0003,0.0001,5.0021,0,0,1";
  text.replace(text.find(vector), vector.size(), "20.0003,0.0001,5.0021,0,0,0");
  folder.write("zero.dmo", text);
  const CommandResult result = abbe({"import", "zero.dmo", "-o", "zero.csv"});
  EXPECT_EQ(result.exit_code, ExitCode::bad_input) << result.out;
  EXPECT_THAT(result.err, HasSubstr("zero.dmo:8:"));
}

TEST_F(ImportOfInstruments, JsonSaysTheSame) {
  const auto json = nlohmann::json::parse(imported(kSamples + "streams.xml", {"--json"}).out);
  EXPECT_EQ(json.at("format"), "mtconnect");
  EXPECT_EQ(json.at("format_reason"), "XML with the root MTConnectStreams");
  EXPECT_TRUE(json.at("layout").is_null());
  EXPECT_EQ(json.at("facts").at(0).at("name"), "creationTime");
  EXPECT_EQ(json.at("columns").at(1).at("from"), "X");
  EXPECT_EQ(json.at("rows"), 6);
  EXPECT_TRUE(json.at("certain").get<bool>());
  folder.write("table.csv", "x_mm,y_mm,z_mm\n1.5,2,3\n");
  const auto table = nlohmann::json::parse(imported("table.csv", {"--json"}).out);
  EXPECT_EQ(table.at("format"), "table");
  EXPECT_EQ(table.at("facts").size(), 0U);
}

TEST_F(ImportOfInstruments, CircularTestsComeFromTables) {
  // The readings of the example, as a program with German names would export them.
  std::string table = "Winkel [°];Drehrichtung;Radialabweichung [µm]\n",
              own = folder.read(ABBE_SOURCE_DIR "/examples/evaluate/circular.csv");
  std::istringstream rows(own.substr(own.find("angle_deg,")));
  std::string row;
  std::getline(rows, row);
  ASSERT_EQ(row, "angle_deg,direction,deviation_um");
  while (std::getline(rows, row)) {
    const std::size_t first = row.find(','), second = row.find(',', first + 1);
    std::string deviation = row.substr(second + 1);
    if (const std::size_t point = deviation.find('.'); point != std::string::npos) deviation[point] = ',';
    table += row.substr(0, first) + ';' + (row.substr(first + 1, second - first - 1) == "cw" ? "G2" : "G3") + ';' +
             deviation + '\n';
  }
  folder.write("bar.txt", table);
  const CommandResult result = imported("bar.txt", {"-o", "bar.csv"});
  EXPECT_THAT(result.out, HasSubstr("read as circular (all columns that it needs are there)"));
  EXPECT_THAT(result.out, HasSubstr("ccw is G3, cw is G2"));
  const auto figures = [&](const std::string& file) {
    return evaluated({"evaluate", "circular", file, "--radius-mm", "150", "--json"}).at("figures");
  };
  EXPECT_EQ(figures("bar.csv"), figures(ABBE_SOURCE_DIR "/examples/evaluate/circular.csv"));
}

}  // namespace
}  // namespace abbe
