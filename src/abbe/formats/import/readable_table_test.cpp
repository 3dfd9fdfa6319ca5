#include "abbe/formats/import/readable_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "abbe/formats/evaluations/evaluation_positioning.h"
#include "abbe/formats/evaluations/section_file.h"
#include "abbe/formats/files/temporary_file_for_test.h"
#include "abbe/formats/import/gzip_for_test.h"
#include "abbe/formats/shapes/mesh_file.h"
#include "abbe/formats/shapes/point_cloud_file.h"
#include "abbe/formats/text/message_of.h"

namespace abbe {
namespace {

using test::gzip_of;
using test::TemporaryFile;
using test::utf16_of;
using testing::HasSubstr;

const std::vector<CsvColumn> kWanted = {{"x", Quantity::length},
                                        {"y", Quantity::length},
                                        {"angle", Quantity::angle, false, false},
                                        {"target", Quantity::length, false, false},
                                        {"target", Quantity::angle, false, false},
                                        {"point", Quantity::dimensionless, true, false}};

std::string plain(const std::string& text, const ColumnMapping& mapping = {}) {
  return plain_table(text, "t.csv", kWanted, mapping).value_or("unchanged");
}

TEST(PlainTable, KeepsLinesInTheirPlaces) {
  EXPECT_EQ(plain("Title\n# why\npoint;x;y\n;mm;um\nP1;1,50;2\n\nP2;-3;4,25\n"),
            "\n\npoint,x_mm,y_um\n\nP1,1.50,2\n\nP2,-3,4.25\n");
  EXPECT_EQ(plain("x_mm\ty_mm\r\n1\t2\r\n"), "x_mm,y_mm\n1,2\n");
  EXPECT_EQ(plain("x_mm  y_mm\n1   2.5\n"), "x_mm,y_mm\n1,2.5\n");
  EXPECT_EQ(plain("\xEF\xBB\xBFx_mm;y_mm;\n1;2;\n"), "x_mm,y_mm\n1,2\n");
}

TEST(PlainTable, ConvertsUnitsExactly) {
  EXPECT_EQ(plain("x_inch,y_in,angle_gon\n1,0.001,100\n"), "x_mm,y_mm,angle_deg\n25.4,0.0254,90.0\n");
  EXPECT_EQ(plain("x [inch],y (mm),angle [deg]\n1,2,3\n"), "x_mm,y_mm,angle_deg\n25.4,2,3\n");
  EXPECT_EQ(plain("x_mm;y_mm;angle [dms]\n1;2;0:01:30\n"), "x_mm,y_mm,angle_arcsec\n1,2,90\n");
  // "1.234,5" has thousands.
  EXPECT_EQ(plain("x_mm;y_mm\n1.234,5;2\n"), "x_mm,y_mm\n1234.5,2\n");
}

TEST(PlainTable, IsNotMadeOfWhatIsReadAsItStands) {
  for (const char* const text : {"x_mm,y_mm\n1,2\n", "# why\n\nx_mm,y_mm\n1,2\nx,y\n", "x_mm,y_mm\n1,two\n3,4\n",
                                 "1,2\n3,4\n", "", "x_mm,y_mm\n", "point,y_furlong\nP,1\n"}) {
    EXPECT_EQ(plain(text), "unchanged") << text;
  }
}

TEST(PlainTable, LeavesNamesAndWrongFieldsToTheReader) {
  // Names that look like numbers stay names, and a field that is none is shown as it stands.
  EXPECT_EQ(plain("point;x_mm;y_mm\n1,5;2,5;3\n1,6;a;4\n"), "point,x_mm,y_mm\n\"1,5\",2.5,3\n\"1,6\",a,4\n");
  EXPECT_EQ(plain("East;North\n1,5;2\n", {{{"x_mm", "East"}}, {}}), "East,North\n1.5,2\n");
  EXPECT_EQ(plain("x_mm;y_mm;note in\n1;2;3,5\n", {{}, {"note in"}}), "x_mm,y_mm,note in\n1,2,\"3,5\"\n");
}

TEST(PlainTable, RefusesWhatHasTwoMeanings) {
  const auto message = [](const std::string& text, const ColumnMapping& mapping = {}) {
    return message_of([&] { plain_table(text, "t.csv", kWanted, mapping); });
  };
  EXPECT_THAT(message("x_mm;y_mm\n1,234;2,345\n"), HasSubstr("may have decimals or thousands"));
  EXPECT_THAT(message("x_mm;y_mm\n1,234;2,345\n"), HasSubstr("abbe import FILE --decimal"));
  EXPECT_EQ(message("target [\"];x_mm;y_mm\n1;2;3\n"),
            "t.csv:1: target [\"]: '\"' may be inch or arcsec; expected target_mm or target_arcsec as the name of the "
            "column");
  EXPECT_THAT(message("angle;x;y\ngrad;mm;mm\n1;2;3\n"), HasSubstr("t.csv:2: angle: 'grad' is a degree in German"));
  EXPECT_THAT(message("East;y\ninch;mm\n1,5;2\n", {{{"x_mm", "East"}}, {}}),
              HasSubstr("t.csv:2: East: the file says inch, and the column is to be read as x_mm"));
  EXPECT_THAT(message("x_mm;y_mm\n1,5;2\n2;2\n1;2;3\n"), HasSubstr("t.csv:4:1: the row has 3 fields; expected 2"));
}

TEST(PlainPoints, AreNumbersBetweenBlanks) {
  const auto points = [](const std::string& text) { return plain_points(text, "t.xyz").value_or("unchanged"); };
  EXPECT_EQ(points("1,5;2;3\n4;5,25;6\n"), "1.5 2 3\n4 5.25 6\n");
  EXPECT_EQ(points("1.5,2,3\n4,5,6\n"), "1.5 2 3\n4 5 6\n");
  EXPECT_EQ(points("1,5 2 3\n\n4 5 6\n"), "1.5 2 3\n\n4 5 6\n");
  EXPECT_EQ(points("1.5 2 3\n4 5 6\n"), "unchanged");
  EXPECT_EQ(points("x;y;z\n1;2;3\n"), "unchanged");
}

TEST(ReadableFiles, OfReadingsAreTheSameInEveryForm) {
  const std::string csv = "run,direction,target_mm,deviation_um\n";
  std::string own = csv, german = "Messung\nrun;direction;target;deviation\n;;mm;um\n", inches;
  inches = "run\tdirection\ttarget_inch\tdeviation_um\n";
  for (int run = 1; run <= 2; ++run) {
    for (const char* const direction : {"+", "-"}) {
      for (int k = 0; k < 5; ++k) {
        const std::string begin = std::to_string(run) + ",";
        const std::string mm = std::to_string(254 * k), inch = std::to_string(10 * k);
        const std::string um = std::to_string(run + k) + ".25", comma = std::to_string(run + k) + ",25";
        own += begin + direction + "," + mm + "," + um + "\n";
        german += std::to_string(run) + ";" + direction + ";" + mm + ";" + comma + "\n";
        inches += std::to_string(run) + "\t" + direction + "\t" + inch + "\t" + um + "\n";
      }
    }
  }
  const PositioningFile expected = parse_positioning(own, "own.csv");
  for (const std::string& bytes : {own, gzip_of(own), german, gzip_of(german), "\xFF\xFE" + utf16_of(german, false),
                                   inches, "# f\xFCr\n" + german}) {
    const TemporaryFile file(bytes, ".csv");
    const PositioningFile read = read_positioning(file.path());
    ASSERT_EQ(read.readings.size(), expected.readings.size());
    for (std::size_t i = 0; i < read.readings.size(); ++i) {
      EXPECT_EQ(read.readings[i].target, expected.readings[i].target);
      EXPECT_EQ(read.readings[i].deviation, expected.readings[i].deviation);
    }
  }
  // Lines of messages are those of the file.
  const TemporaryFile wrong("Messung\nrun;direction;target;deviation\n;;mm;um\n1;+;0;1,5\n1;up;10;2\n", ".csv");
  EXPECT_THAT(message_of([&] { read_positioning(wrong.path()); }), HasSubstr(".csv:5: direction: "));
  const TemporaryFile packed("\x1f\x8b\x08 damaged", ".csv");
  EXPECT_THAT(message_of([&] { read_positioning(packed.path()); }), HasSubstr("gzip"));
}

TEST(ReadableFiles, OfPointsMayBeOfAnyForm) {
  const auto points = [](const std::string& bytes, const std::string& ending, const PointCloudOptions& options = {}) {
    const TemporaryFile file(bytes, ending);
    return read_point_cloud(file.path(), options).cloud.points;
  };
  const Eigen::Matrix3Xd expected = points("x_mm,y_mm,z_mm\n25.4,0,1.5\n-50.8,2.54,0\n", ".csv");
  const std::string inches = "x_in;y_in;z_mm\n1;0;1,5\n-2;0,1;0\n";
  EXPECT_EQ(points(inches, ".csv"), expected);
  EXPECT_EQ(points(gzip_of(inches), ".csv.gz"), expected);
  EXPECT_EQ(points(utf16_of(inches, true), ".csv"), expected);
  EXPECT_EQ(points("x\ty\tz\nmm\tmm\tmm\n25,4\t0\t1,5\n-50,8\t2,54\t0\n", ".txt"), expected);
  EXPECT_EQ(points("25,4;0;1,5\n-50,8;2,54;0\n", ".xyz"), expected);
  EXPECT_EQ(points(gzip_of("25.4 0 1.5\n-50.8 2.54 0\n"), ".xyz.gz"), expected);
  EXPECT_EQ(points("East;y;z\n[mm];[mm];[mm]\n25,4;0;1,5\n-50,8;2,54;0\n", ".csv",
                   {.unit = {}, .mapping = {{{"x_mm", "East"}}, {}}}),
            expected);
}

TEST(ReadableFiles, OfPartsMayBePacked) {
  const std::string stl =
      "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
      "facet normal 0 0 1\nouter loop\nvertex 1 0 0\nvertex 1 1 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\n";
  const TemporaryFile file(gzip_of(stl), ".stl.gz");
  EXPECT_EQ(read_mesh(file.path(), {}).mesh.triangles.cols(), 2);
}

TEST(ReadableFiles, WithNamesKeepThem) {
  const TemporaryFile file(
      "section;across_mm;height_mm\nS\xFC"
      "d;0,5;1\nS\xFC"
      "d;1,5;2\n",
      ".csv");
  const std::vector<SectionReadings> sections = read_sections(file.path());
  ASSERT_EQ(sections.size(), 1U);
  EXPECT_EQ(sections[0].name, "Süd");
  EXPECT_EQ(sections[0].points(0, 1), 1.5);
}

}  // namespace
}  // namespace abbe
