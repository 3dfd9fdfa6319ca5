#include "abbe/formats/import/instrument_format.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "abbe/formats/import/instrument_for_test.h"

namespace abbe {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::string recognised_name(const std::string& text) {
  const std::optional<RecognisedFormat> found = recognise_instrument(text);
  return found ? std::string(found->format->name) : "";
}

TEST(InstrumentFormats, HaveNamesOfTheirOwn) {
  std::set<std::string_view> names = {kTableFormat};
  for (const InstrumentFormat& format : instrument_formats()) {
    EXPECT_TRUE(names.insert(format.name).second) << format.name;
    EXPECT_EQ(instrument_format_named(format.name), &format);
  }
  EXPECT_EQ(import_format_names().size(), names.size());
  EXPECT_EQ(instrument_format_named(kTableFormat), nullptr);
}

TEST(InstrumentFormats, AreRecognisedByTheirContents) {
  EXPECT_EQ(recognised_name("\r\nHEADER::\r\nFile type  : rtl\r\n"), "renishaw-laser");
  EXPECT_EQ(recognised_name("<?xml version=\"1.0\"?><!-- <a> --><q:QIFDocument xmlns:q=\"u\"/>"), "qif");
  EXPECT_EQ(recognised_name("<MTConnectStreams>"), "mtconnect");
  EXPECT_EQ(recognised_name("$$ output\nfilnam/'a',5.3\n"), "dmis");
  EXPECT_EQ(recognised_name("$$ no header\nFA(P1)=FEAT/POINT,CART,1,2,3,0,0,1\n"), "dmis");
  EXPECT_EQ(recognised_name("BEGIN POINTS.TAB MM\n"), "heidenhain-table");
  EXPECT_EQ(recognised_name("BEGIN POINTS 2.PNT INCH Version: 'Update:1.0'\r\n"), "heidenhain-table");
  EXPECT_EQ(recognised_name("BEGIN POINTS.TAB\n"), "heidenhain-table");
  EXPECT_EQ(recognised_name("<BALLBAR><FEATURE NAME=\"AF_CIRCULARITY\" DT=\"UT_LENGTH_UM\">4</FEATURE></BALLBAR>"),
            "renishaw-ballbar");
  EXPECT_EQ(recognised_name("1.000000 2.000000 3.000000 0.000000 0.000000 0.000000 0.000000 0.000000 0.000000\n"),
            "linuxcnc-probe");
}

TEST(InstrumentFormats, AreNotSeenInTables) {
  EXPECT_EQ(recognised_name(""), "");
  EXPECT_EQ(recognised_name("x_mm,y_mm,z_mm\n1,2,3\n"), "");
  EXPECT_EQ(recognised_name("HEADER::\nx,y,z\n1,2,3\n"), "");
  EXPECT_EQ(recognised_name("<html><p>FEATURE</p></html>"), "");
  EXPECT_EQ(recognised_name("<!-- <QIFDocument> -->"), "");
  EXPECT_EQ(recognised_name("<QIFDocuments/>"), "");
  EXPECT_EQ(recognised_name("<"), "");
  EXPECT_EQ(recognised_name("$$ a comment\nx y z\n1 2 3\n"), "");
  EXPECT_EQ(recognised_name("1.0 2.0 3.0 0.0 0.0 0.0 0.0 0.0 0.0\n"), "");
  EXPECT_EQ(recognised_name("1.000000 2.000000 3.000000\n"), "");
  EXPECT_EQ(recognised_name("BEGIN PGM POINTS MM\n"), "");
  EXPECT_EQ(recognised_name("BEGIN PGM A.H MM\n"), "");
  EXPECT_EQ(recognised_name("BEGIN x,y,z MM\n1,2,3\n"), "");
  EXPECT_EQ(recognised_name("BEGIN .TAB MM\n"), "");
  EXPECT_EQ(recognised_name("BEGIN  MM"), "");
}

TEST(InstrumentFormats, PutWhatIsCertainBeforeWhatIsPossible) {
  const std::string log = "1.000000 2.000000 3.000000 0.000000 0.000000 0.000000 0.000000 0.000000 0.000000\n";
  EXPECT_FALSE(recognise_instrument(log)->recognition.certain);
  EXPECT_TRUE(recognise_instrument("HEADER::\nFile type: rtl\n")->recognition.certain);
  EXPECT_TRUE(recognise_instrument("BEGIN A.TAB MM\n")->recognition.certain);
  EXPECT_FALSE(recognise_instrument("BEGIN A.TAB\n")->recognition.certain);
}

TEST(LinuxCncProbeLog, HasNinePositionsInEveryLine) {
  const InstrumentTable table = read_as("linuxcnc-probe",
                                        "1.500000 -2.000000 3.250000 0.000000 0.000000 0.000000 0.000000 0.000000 "
                                        "0.000000\n\n-0.500000 2.000000 3.000000 0.000000 0.000000 0.000000 0.000000 "
                                        "0.000000 0.000000");
  EXPECT_EQ(table.kind, ImportKind::points);
  EXPECT_EQ(table.rows, "1.500000,-2.000000,3.250000\n-0.500000,2.000000,3.000000\n");
  EXPECT_THAT(table.lines, ElementsAre(1, 3));
  EXPECT_THAT(table.doubts, IsEmpty());
  ASSERT_EQ(table.columns.size(), 3U);
  EXPECT_EQ(table.columns[1].base, "y");
  EXPECT_FALSE(table.columns[1].unit_is_stated);
  EXPECT_THAT(table.columns[1].doubts, ElementsAre(HasSubstr("G21; range -2 to 2; --length-unit inch for G20")));
  EXPECT_THAT(table.not_read, ElementsAre("A (0 in every line)", "B (0 in every line)", "C (0 in every line)",
                                          "U (0 in every line)", "V (0 in every line)", "W (0 in every line)"));
}

TEST(LinuxCncProbeLog, IsInTheUnitOfItsProgram) {
  ImportHints hints;
  hints.length_unit = "inch";
  const InstrumentTable table = read_as(
      "linuxcnc-probe", "1.500000 -2.000000 3.250000 0.000000 0.000000 0.000000 0.000000 0.000000 0.000000\n", hints);
  EXPECT_EQ(table.columns[0].unit, "inch");
  EXPECT_TRUE(table.columns[0].unit_is_stated);
  EXPECT_THAT(table.columns[0].doubts, IsEmpty());
}

TEST(LinuxCncProbeLog, OfOtherAxesThatMovedIsInDoubt) {
  const InstrumentTable table =
      read_as("linuxcnc-probe",
              "1.000000 2.000000 3.000000 0.000000 0.000000 0.000000 0.000000 0.000000 5.000000\n"
              "1.000000 2.000000 3.000000 0.000000 0.000000 90.000000 0.000000 0.000000 5.000000\n");
  EXPECT_THAT(table.doubts,
              ElementsAre("C moved between the points, which may then not be in one frame of the workpiece"));
  EXPECT_EQ(table.not_read[2], "C (0 to 90)");
  EXPECT_EQ(table.not_read[5], "W (5 in every line)");
}

TEST(LinuxCncProbeLog, RefusesLinesThatAreNotWhole) {
  const std::string line = "1.000000 2.000000 3.000000 0.000000 0.000000 0.000000 0.000000 0.000000 0.000000\n";
  EXPECT_EQ(refusal_of("linuxcnc-probe", line + "1.000000 2.0000"),
            "t:2: the line has 2 fields; expected 9 numbers: X Y Z A B C U V W");
  EXPECT_EQ(refusal_of("linuxcnc-probe",
                       line + "1.000000 2.000000 3.000000 0.000000 0.000000 0.000000 0.000000 0.000000 0.00"),
            "t:2: W: '0.00' is not as LinuxCNC writes numbers; expected a number with six decimals");
  EXPECT_EQ(
      refusal_of("linuxcnc-probe", "1.000000 nan 3.000000 0.000000 0.000000 0.000000 0.000000 0.000000 0.000000\n"),
      "t:1: Y: 'nan' is not a finite number; expected a number with six decimals");
  EXPECT_EQ(refusal_of("linuxcnc-probe",
                       "9999999999.000000 2.000000 3.000000 0.000000 0.000000 0.000000 0.000000 0.000000 0.000000\n"),
            "t:1: X: '9999999999.000000' is too large; expected a number with six decimals");
}

}  // namespace
}  // namespace abbe
