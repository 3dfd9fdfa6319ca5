#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "abbe/formats/import/instrument_for_test.h"
#include "abbe/formats/text/replaced_text_for_test.h"

namespace abbe {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// In the form of the file that docs/import.md cites.
const std::string kLaser =
    "HEADER::\nFile type  : rtl\nOwner      : Linear\nVersion no : V20.02.01\n\n"
    "TARGET DATA::\nFiletype  : ISO\nTarget-count: 3\nTargets :\n-280.000000  -230.000000 \n-180.000000 \n"
    "Flags: 0 0 2 1\n\n"
    "USER-TEXT::\nMachine:lathe\nSerial No:\nDate:2014-10-08 10:53:29\n\nRUNS::\nRun-count:2\n\n"
    "DEVIATIONS::\nRun Target Data:\n1   1      -0.700\n1   2      -0.200\n1   3      -1.400\n"
    "2   3      -2.100\n2   2      -1.000\n2   1      -1.500\n\n"
    "ENVIRONMENT::\nAir temp   : 26.234373 26.281248 0\nAir humid  : 37.378903 37.653946\n"
    "Date Time  : \"2014-10-08 10:53:4\" \"2014-10-08 10:56:49\"\n\nEOF::\n";

std::string changed(const std::string& from, const std::string& to) { return test::replaced(kLaser, from, to); }

InstrumentTable laser_table(const std::string& text, const std::string& length_unit = "mm") {
  ImportHints hints;
  hints.length_unit = length_unit;
  return read_as("renishaw-laser", text, hints);
}

std::string laser_refusal(const std::string& from, const std::string& to) {
  return refusal_of("renishaw-laser", changed(from, to));
}

TEST(RenishawLaserFile, HasRunsFromBothSides) {
  const InstrumentTable table = laser_table(kLaser);
  EXPECT_EQ(table.kind, ImportKind::positioning);
  EXPECT_EQ(table.rows,
            "1,+,-280.000000,-0.700\n1,+,-230.000000,-0.200\n1,+,-180.000000,-1.400\n"
            "2,-,-180.000000,-2.100\n2,-,-230.000000,-1.000\n2,-,-280.000000,-1.500\n");
  EXPECT_THAT(table.lines, ElementsAre(24, 25, 26, 27, 28, 29));
  EXPECT_THAT(table.doubts, IsEmpty());
  EXPECT_THAT(table.reasons,
              ElementsAre("3 targets from -280 to -180", "2 runs: 1 towards larger positions, 1 towards smaller ones"));
  std::string facts;
  for (const InstrumentFact& fact : table.facts) facts += fact.name + "=" + fact.value + ";";
  EXPECT_EQ(facts,
            "Owner=Linear;Version no=V20.02.01;Filetype=ISO;Machine=lathe;Date=2014-10-08 10:53:29;"
            "Air temp=26.234373 26.281248 0;Air humid=37.378903 37.653946;"
            "Date Time=\"2014-10-08 10:53:4\" \"2014-10-08 10:56:49\";");
  EXPECT_THAT(table.not_read, ElementsAre("Flags '0 0 2 1' but for the second, which tells runs from one side"));
}

TEST(RenishawLaserFile, IsReadWithOtherLineEndsAndSpaces) {
  std::string crlf;
  for (const char c : kLaser) crlf += c == '\n' ? std::string("\r\n") : std::string(1, c);
  EXPECT_EQ(laser_table(crlf).rows, laser_table(kLaser).rows);
  EXPECT_EQ(laser_table("\n\n" + changed("1   1      -0.700", " 1\t1 -0.700 ")).rows, laser_table(kLaser).rows);
  EXPECT_EQ(laser_table(changed("Targets :\n", "Targets : ")).rows, laser_table(kLaser).rows);
}

TEST(RenishawLaserFile, DoesNotStateItsUnits) {
  const InstrumentTable table = laser_table(kLaser, "");
  ASSERT_EQ(table.columns.size(), 4U);
  EXPECT_EQ(table.columns[2].base, "target");
  EXPECT_EQ(table.columns[2].unit, "mm");
  EXPECT_THAT(table.columns[2].doubts, ElementsAre(HasSubstr("states no unit; mm is assumed")));
  EXPECT_EQ(table.columns[3].base, "deviation");
  EXPECT_EQ(table.columns[3].unit, "um");
  EXPECT_THAT(table.columns[3].doubts, ElementsAre(HasSubstr("states no unit; um is assumed")));
  for (const InstrumentColumn& column : laser_table(kLaser).columns) EXPECT_THAT(column.doubts, IsEmpty());
  EXPECT_EQ(message_of([] { laser_table(kLaser, "inch"); }),
            "--length-unit: inch is not known of such files; expected mm, with deviations in um; other units by a "
            "mapping file (--mapping)");
}

TEST(RenishawLaserFile, TellsTheDirectionByTheOrderOfTheTargets) {
  // Targets from right to left: the first run goes towards smaller positions.
  const InstrumentTable table = laser_table(changed("-280.000000  -230.000000 \n-180.000000 ", "30  20\n10"));
  EXPECT_THAT(table.rows, HasSubstr("1,-,30,-0.700\n"));
  EXPECT_THAT(table.rows, HasSubstr("2,+,10,-2.100\n"));
  EXPECT_EQ(laser_refusal("1   3      -1.400\n", "1   3      -1.400\n1   2   1\n"),
            "t:27: Target: run 1 goes from target 3 to target 2, not on in one direction; expected targets in the "
            "order of their positions, which shows the side from which each was approached");
  EXPECT_THAT(laser_refusal("-280.000000  -230.000000", "-230.000000  -230.000000"),
              HasSubstr("t:25: Target: run 1 goes from target 1 to target 2, not on in one direction"));
  const InstrumentTable forth = laser_table(
      test::replaced(changed("2   3      -2.100\n2   2      -1.000\n2   1      -1.500", "2 1 -1.5\n2 2 -1\n2 3 -2.1"),
                     "0 0 2 1", "0 0 2 0"));
  EXPECT_THAT(forth.doubts, ElementsAre("the Flags speak of runs from both sides, and the order of the targets is that "
                                        "of one side"));
}

TEST(RenishawLaserFile, LeavesOutTargetsThatWereNotMeasured) {
  const InstrumentTable table = laser_table(changed("-2.100", "-100000000000000000000.000"));
  EXPECT_EQ(table.lines.size(), 5U);
  EXPECT_THAT(table.rows, Not(HasSubstr("-2.100")));
  EXPECT_THAT(table.rows, HasSubstr("2,-,-230.000000,-1.000\n"));
  EXPECT_THAT(table.not_read, Contains("1 target without a reading (-1e20)"));
  EXPECT_THAT(table.doubts, IsEmpty());
}

TEST(RenishawLaserFile, LeavesOutRunsOfZerosOfATestFromOneSide) {
  const std::string one_side = test::replaced(
      changed("2   3      -2.100\n2   2      -1.000\n2   1      -1.500", "2 3 0\n2 2 0\n2 1 0"), "0 0 2 1", "0 1 2 0");
  const InstrumentTable table = laser_table(one_side);
  EXPECT_EQ(table.lines.size(), 3U);
  EXPECT_THAT(table.not_read, Contains("1 run of nothing but zeros, for the way back"));
  EXPECT_THAT(table.doubts, IsEmpty());
  const InstrumentTable both = laser_table(test::replaced(one_side, "2 2 0", "2 2 0.1"));
  EXPECT_EQ(both.lines.size(), 6U);
  EXPECT_THAT(both.doubts, ElementsAre("the Flags speak of runs from one side, and there are both"));
  // Zeros of a test from both sides are readings.
  EXPECT_EQ(laser_table(test::replaced(one_side, "0 1 2 0", "0 0 2 0")).lines.size(), 6U);
}

TEST(RenishawLaserFile, ThatMayBeCutShortIsInDoubt) {
  const InstrumentTable table = laser_table(kLaser.substr(0, kLaser.find("\n2   1 ") + 1));
  EXPECT_EQ(table.lines.size(), 5U);
  EXPECT_THAT(table.doubts, ElementsAre("5 of the 6 readings of all runs are there",
                                        "the file does not end in EOF::, so it may be cut short"));
  EXPECT_THAT(laser_table(changed("Owner      : Linear", "Owner : Angular")).doubts,
              ElementsAre("its Owner is not Linear, so its readings may be something else than positions"));
}

TEST(RenishawLaserFile, AtEveryLengthIsReadOrRefused) {
  for (std::size_t length = 0; length < kLaser.size(); ++length) {
    try {
      const InstrumentTable table = laser_table(kLaser.substr(0, length));
      EXPECT_EQ(table.doubts.empty(), kLaser.substr(0, length).ends_with("EOF::")) << length;
    } catch (const InputError& error) {
      EXPECT_NE(error.expected(), "") << length << error.what();
    }
  }
}

TEST(RenishawLaserFile, RefusesWhatItDoesNotKnow) {
  EXPECT_THAT(laser_refusal(": rtl", ": rta"), HasSubstr("t:2: File type: 'rta' is not read; expected rtl"));
  EXPECT_EQ(laser_refusal("File type  : rtl\n", ""), "t: File type: is missing; expected rtl");
  EXPECT_EQ(laser_refusal("Target-count: 3", "Target-count: 4"),
            "t:8: Target-count: is 4, and 3 targets are listed; expected as many targets as are listed");
  EXPECT_EQ(laser_refusal("Target-count: 3", "Target-count: -3"),
            "t:8: Target-count: '-3' is no such number; expected a whole number from 1 to 1000000");
  EXPECT_EQ(laser_refusal("Target-count: 3\n", ""), "t: Target-count: is missing; expected the number of targets");
  EXPECT_EQ(laser_refusal("Run-count:2\n", ""), "t: Run-count: is missing; expected the number of runs");
  EXPECT_EQ(laser_refusal("-230.000000", "-230,0"),
            "t:10: Targets: '-230,0' is not a number; expected a position in mm");
  EXPECT_EQ(laser_refusal("-0.200", "-0.2O0"), "t:25: Data: '-0.2O0' is not a number; expected a deviation in um");
  EXPECT_EQ(laser_refusal("-0.200", "1e10"), "t:25: Data: '1e10' is too large; expected a deviation in um");
  EXPECT_EQ(laser_refusal("1   2      -0.200", "1   2"),
            "t:25: Run Target Data: the line has 2 fields; expected run, target and deviation in um");
  EXPECT_EQ(laser_refusal("2   1      -1.500", "3   1      -1.500"), "t:29: Run: is 3; expected 1 to 2");
  EXPECT_EQ(laser_refusal("2   1      -1.500", "2   9      -1.500"), "t:29: Target: is 9; expected 1 to 3");
  EXPECT_EQ(laser_refusal("Filetype  : ISO", "Filetype"),
            "t:7: TARGET DATA: 'Filetype' is no key with a value; expected 'key : value'");
  EXPECT_EQ(refusal_of("renishaw-laser", kLaser.substr(0, kLaser.find("1   1 ")) + "EOF::\n"),
            "t: Run Target Data: there are no readings; expected run, target and deviation in um");
  EXPECT_THAT(refusal_of("renishaw-laser",
                         test::replaced(changed("2   3      -2.100\n2   2      -1.000\n", ""), "-1.500", "-1")),
              HasSubstr("t:27: Run: run 2 has only one target, so its direction is unknown"));
}

}  // namespace
}  // namespace abbe
