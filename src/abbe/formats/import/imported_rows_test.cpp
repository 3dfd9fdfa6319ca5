#include "abbe/formats/import/imported_rows.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "abbe/formats/import/proposed_mapping.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/text/message_of.h"
#include "abbe/formats/text/number_text.h"

namespace abbe {
namespace {

using testing::HasSubstr;

const Machine& column_of_import() {
  static const Machine machine =
      parse_machine("name = \"m\"\nchain = \"w b X t\"\n[axis.X]\ntravel_mm = [0, 1400]\n", "m.toml");
  return machine;
}

ImportedRows rows_of(const std::string& text, const std::string& mapping, int threads = 0) {
  const ImportMapping read = parse_import_mapping(mapping, "m.import.toml");
  return imported_rows(text, "t.txt", layout_as_given(text, "t.txt", read.layout), read, column_of_import(), threads);
}

std::string message_of_rows(const std::string& text, const std::string& mapping) {
  return message_of([&] { rows_of(text, mapping); });
}

const std::string kSemicolons =
    "kind = \"points\"\n[layout]\nseparator = \"semicolon\"\ndecimal = \"comma\"\nheader_line = 1\nfirst_line = 2\n";

std::string column_lines(const std::string& name, const std::string& from,
                         const std::string& more = "unit = \"mm\"\n") {
  return "[[column]]\nname = \"" + name + "\"\nfrom = \"" + from + "\"\n" + more;
}

const std::string kPoints = kSemicolons + column_lines("point", "n", "") + column_lines("x_mm", "x") +
                            column_lines("y_mm", "y") + column_lines("z_mm", "z");

TEST(ImportedTableRows, KeepDigitsAndNames) {
  const ImportedRows rows = rows_of("n;x;y;z\n\"A, b\";1,50;-2;3e2\n\n;;;\n;,5;0;0,1234567890123456789\n", kPoints);
  EXPECT_EQ(rows.csv, "point,x_mm,y_mm,z_mm\n\"A, b\",1.50,-2,3e2\n\"\",.5,0,0.1234567890123456789\n");
  EXPECT_EQ(rows.rows, 2U);
  EXPECT_EQ(rows.blank_lines, 2U);
  EXPECT_EQ(rows.comment_lines, 0U);
}

TEST(ImportedTableRows, ConvertUnitsExactly) {
  const auto x_of = [](const std::string& value, const std::string& unit, const std::string& name,
                       const std::string& convention = "") {
    const std::string csv = rows_of("x;y;z\n" + value + ";0;0\n",
                                    kSemicolons + column_lines(name, "x", "unit = \"" + unit + "\"\n" + convention) +
                                        column_lines("y_mm", "y") + column_lines("z_mm", "z"))
                                .csv;
    const std::size_t line = csv.find('\n') + 1;
    return csv.substr(line, csv.find(',', line) - line);
  };
  EXPECT_EQ(x_of("1,00003", "inch", "x_mm"), "25.400762");
  EXPECT_EQ(x_of("-3,7", "thou", "x_um"), "-93.98");
  EXPECT_EQ(x_of("12", "uinch", "x_um"), "0.3048");
  EXPECT_EQ(x_of("2,5", "foot", "x_mm"), "762.00");
  EXPECT_EQ(x_of("12,34", "cm", "x_mm"), "123.4");
  EXPECT_EQ(x_of("1,5", "m", "x_m"), "1.5");
  EXPECT_EQ(x_of("250", "nm", "x_um"), "0.250");
  EXPECT_EQ(x_of("1,50", "mm", "x_mm", "convention = \"reversed\"\n"), "-1.50");
  EXPECT_EQ(x_of("0,0", "mm", "x_mm", "convention = \"reversed\"\n"), "0.0");
}

TEST(ImportedTableRows, TurnZenithAndClockwiseAngles) {
  const auto angles = [](const std::string& azimuth, const std::string& zenith, const std::string& unit,
                         const std::string& suffix) {
    const std::string csv =
        rows_of("X;r;a;e\n1;1000;" + azimuth + ";" + zenith + "\n",
                "kind = \"tracker\"\n" + kSemicolons.substr(kSemicolons.find('\n') + 1) + column_lines("X_mm", "X") +
                    column_lines("range_mm", "r") +
                    column_lines("azimuth_" + suffix, "a", "unit = \"" + unit + "\"\nconvention = \"clockwise\"\n") +
                    column_lines("elevation_" + suffix, "e", "unit = \"" + unit + "\"\nconvention = \"zenith\"\n"))
            .csv;
    const std::size_t begin = csv.find("1000,") + 5;
    return csv.substr(begin, csv.size() - 1 - begin);
  };
  EXPECT_EQ(angles("30,25", "88,1200", "deg", "deg"), "-30.25,1.8800");
  EXPECT_EQ(angles("100", "100,0001", "gon", "deg"), "-90.0,-0.00009");
  EXPECT_EQ(angles("0", "180", "deg", "deg"), "0,-90");
  EXPECT_EQ(angles("10°00'30,5\"", "90°00'01,5\"", "deg-min-sec", "arcsec"), "-36030.5,-1.5");
  EXPECT_EQ(angles("1", "324000,25", "arcsec", "arcsec"), "-1,-0.25");
  // Radians: to the last bits.
  const std::string radians = angles("1,5", "1,5", "rad", "rad");
  double elevation = 0;
  ASSERT_EQ(parse_number(radians.substr(radians.find(',') + 1), 0, elevation), NumberProblem::none) << radians;
  EXPECT_NEAR(elevation, std::numbers::pi / 2 - 1.5, 1e-16);
  EXPECT_THAT(
      message_of([&] { angles("0", "180,001", "deg", "deg"); }),
      HasSubstr("t.txt:2:10: e: '180,001' is out of range; expected an angle from the zenith, of 0 to 180 degrees"));
  EXPECT_THAT(message_of([&] { angles("0", "-0,001", "gon", "deg"); }), HasSubstr("is out of range"));
  EXPECT_THAT(message_of([&] { angles("0", "3,15", "rad", "rad"); }), HasSubstr("is out of range"));
}

TEST(ImportedTableRows, ThatAreWrongAreRefusedWithTheirPlace) {
  EXPECT_EQ(message_of_rows("n;x;y;z\na;1;2;3\nb;1;2\n", kPoints),
            "t.txt:3:1: the row has 3 fields; expected 4 as in the header");
  // A name less than columns may mean that all names stand one column too far to the left.
  EXPECT_EQ(message_of_rows("n;x;y;z\na;1;2;3;4\n", kPoints),
            "t.txt:2:1: the row has 5 fields; expected 4 as in the header");
  EXPECT_EQ(rows_of("n;x;y;z\na;1;2;3;\n", kPoints).csv, "point,x_mm,y_mm,z_mm\na,1,2,3\n");
  EXPECT_THAT(message_of_rows("n;x;y;z\na;1;2;3;4;5\n", kPoints),
              HasSubstr("t.txt:1: is not a header of the 6 columns of the rows; expected the layout of the mapping"));
  EXPECT_EQ(message_of_rows("n;x;y;z\na;1;2;3\nb;1;2;3;4\n", kPoints),
            "t.txt:3:1: the row has 5 fields; expected 4 as in the header");
  EXPECT_EQ(message_of_rows("n;x;y;z\na;1;n/a;3\n", kPoints),
            "t.txt:2:5: y: 'n/a' is not a number; expected a number with a decimal comma");
  EXPECT_EQ(message_of_rows("n;x;y;z\na;1.5;2;3\n", kPoints),
            "t.txt:2:3: x: '1.5' is not a number; expected a number with a decimal comma");
  EXPECT_EQ(message_of_rows("n;x;y;z\na;1;;3\n", kPoints),
            "t.txt:2:5: y: is empty; expected a number with a decimal comma");
  EXPECT_THAT(message_of_rows("n;x;y;z\na;1;2;4e9\n", kPoints), HasSubstr("z: '4e9' is too large"));
  EXPECT_THAT(message_of_rows("n;x;y;z\n\"a;1;2;3\n", kPoints), HasSubstr("a quote is not closed"));
  EXPECT_THAT(message_of_rows("n;x;y;z\n\n", kPoints), HasSubstr("there are no rows from line 2 on"));
  EXPECT_THAT(message_of_rows("n;a;y;z\na;1;2;3\n", kPoints), HasSubstr("t.txt:1: x: there is no column of this name"));
  EXPECT_THAT(message_of_rows("n;x;y;z;x\na;1;2;3;4\n", kPoints), HasSubstr("x: more than one column has this name"));
  // The header says another unit than the mapping.
  EXPECT_THAT(message_of_rows("n;x [inch];y;z\na;1;2;3\n", kSemicolons + column_lines("x_mm", "x [inch]") +
                                                               column_lines("y_mm", "y") + column_lines("z_mm", "z")),
              HasSubstr("t.txt:1: x [inch]: the file says inch, and the mapping mm"));
}

TEST(ImportedTableRows, DoNotDependOnThreadsOrBlocks) {
  std::string text = "n;x;y;z\n";
  for (int i = 0; i < 60000; ++i) text += "Punkt " + std::to_string(i) + ";" + std::to_string(i) + ",25;0,5;-1\n";
  ASSERT_GT(text.size(), std::size_t{1} << 20);  // of several blocks
  const ImportedRows one = rows_of(text, kPoints, 1), more = rows_of(text, kPoints, 3);
  EXPECT_EQ(one.csv, more.csv);
  EXPECT_EQ(one.rows, 60000U);
  EXPECT_THAT(one.csv, HasSubstr("\nPunkt 59999,59999.25,0.5,-1\n"));
  text += "x;1;2\n";
  EXPECT_THAT(message_of_rows(text, kPoints), HasSubstr("t.txt:60002:1: the row has 3 fields"));
  EXPECT_EQ(imported_line(text, parse_import_mapping(kPoints, "m").layout, 59999), 60001U);
}

TEST(ImportMappingFile, IsReadBackAsItWasWritten) {
  ImportMapping mapping;
  mapping.kind = ImportKind::positioning;
  mapping.encoding = TextEncoding::windows_1252;
  mapping.layout = {FieldSeparator::blanks, DecimalMark::comma, ThousandsMark::apostrophe, "//", 3, 4, 6};
  mapping.columns = {{"direction", "Richtung \"A\"", 0, "", ImportConvention::as_written, {"vor", "↑"}, {"rück"}},
                     {"target_mm", "", 3, "inch", ImportConvention::as_written, {}, {}},
                     {"deviation_um", "", 4, "um", ImportConvention::reversed, {}, {}}};
  const std::string text = import_mapping_text(mapping, {{"a reason\nof two lines"}});
  const ImportMapping read = parse_import_mapping(text, "m.import.toml");
  EXPECT_EQ(import_mapping_text(read), import_mapping_text(mapping));
  EXPECT_EQ(read.layout.thousands, ThousandsMark::apostrophe);
  EXPECT_EQ(read.columns[0].positive, mapping.columns[0].positive);
  EXPECT_EQ(read.columns[2].convention, ImportConvention::reversed);
  EXPECT_EQ(read.encoding, TextEncoding::windows_1252);
}

TEST(ImportMappingFile, IsStrict) {
  const auto message = [](const std::string& text) {
    return message_of([&] { parse_import_mapping(text, "m.import.toml"); });
  };
  EXPECT_THAT(message("kind = \"dots\"\n"), HasSubstr("m.import.toml:1:"));
  EXPECT_THAT(message(kPoints + "colour = 1\n"), HasSubstr("colour"));
  EXPECT_THAT(message(kSemicolons), HasSubstr("no columns are written; expected tables [[column]]"));
  EXPECT_THAT(message(kSemicolons + "[[column]]\nname = \"x_mm\"\n"), HasSubstr("has to say where it comes from"));
  EXPECT_THAT(message(kSemicolons + column_lines("x_mm", "x", "from_column = 2\n")), HasSubstr("one of them"));
  EXPECT_THAT(message(kSemicolons + column_lines("x_mm", "x", "unit = \"furlong\"\n")),
              HasSubstr("'furlong' is not a unit; expected one of mm, um, m,"));
  EXPECT_THAT(message(kSemicolons + column_lines("x_mm", "x") + column_lines("x_mm", "y")),
              HasSubstr("is written twice"));
  EXPECT_THAT(message("kind = \"points\"\n[layout]\nseparator = \"tab\"\ndecimal = \"point\"\nfirst_line = 1\n" +
                      column_lines("x_mm", "x")),
              HasSubstr("the layout has no header_line"));
  EXPECT_THAT(message("kind = \"points\"\n[layout]\nseparator = \"tab\"\ndecimal = \"point\"\nthousands = "
                      "\"point\"\nfirst_line = 1\n"),
              HasSubstr("layout.thousands: is also the decimal mark"));
  EXPECT_THAT(
      message(
          "kind = \"points\"\n[layout]\nseparator = \"tab\"\ndecimal = \"point\"\nheader_line = 2\nfirst_line = 2\n"),
      HasSubstr("is not below the header"));
}

TEST(ImportMappingFile, HasToFitItsKind) {
  const std::string text = "x;y;z\n1;2;3\n", yz = column_lines("y_mm", "y") + column_lines("z_mm", "z");
  EXPECT_THAT(message_of_rows(text, kSemicolons + yz), HasSubstr("m.import.toml: column: no column is written as x"));
  EXPECT_THAT(message_of_rows(text, kSemicolons + yz + column_lines("X_mm", "x")),
              HasSubstr("m.import.toml: column[3].name: 'X_mm' is no column of a table of the kind points"));
  EXPECT_THAT(message_of_rows(text, kSemicolons + column_lines("x_mm", "x", "unit = \"m\"\n") + yz),
              HasSubstr("column[1].name: numbers in m are written in m; expected x_m"));
  EXPECT_THAT(message_of_rows(text, kSemicolons + column_lines("x_mm", "x", "unit = \"deg\"\n") + yz),
              HasSubstr("column[1].unit: is not one of a length; expected one of mm,"));
  EXPECT_THAT(message_of_rows(text, kSemicolons + column_lines("x_mm", "x", "") + yz),
              HasSubstr("column[1].unit: is missing"));
  EXPECT_THAT(message_of_rows(text, kSemicolons + column_lines("point", "x") + yz),
              HasSubstr("this column has no unit"));
  EXPECT_THAT(
      message_of_rows(text, kSemicolons + column_lines("x_mm", "x", "unit = \"mm\"\nconvention = \"zenith\"\n") + yz),
      HasSubstr("column[1].convention: 'zenith' does not belong to x; expected elevation"));
  EXPECT_THAT(message_of_rows(text, kSemicolons + column_lines("x_mm", "x", "unit = \"mm\"\npositive = \"+\"\n") + yz),
              HasSubstr("column[1].positive: this column has no directions"));
}

TEST(ImportMappingFile, SaysWhatDirectionsMean) {
  const std::string mapping = "kind = \"positioning\"\n" + kSemicolons.substr(kSemicolons.find('\n') + 1) +
                              column_lines("direction", "d", "positive = [\"E\", \"e\"]\nnegative = \"W\"\n") +
                              column_lines("target_mm", "t") + column_lines("deviation_um", "a", "unit = \"um\"\n");
  EXPECT_EQ(rows_of("d;t;a\nE;1;2\ne;2;3\nW;1;-0,5\n", mapping).csv,
            "direction,target_mm,deviation_um\n+,1,2\n+,2,3\n-,1,-0.5\n");
  EXPECT_THAT(message_of_rows("d;t;a\n+;1;2\n", mapping),
              HasSubstr("t.txt:2:1: d: '+' is not a direction; expected E, e for +, W for -"));
}

}  // namespace
}  // namespace abbe
