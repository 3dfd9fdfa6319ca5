#include "abbe/formats/text/toml_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "abbe/formats/text/message_of.h"
#include "abbe/formats/text/toml_document.h"

namespace abbe {
namespace {

std::string message_of_toml(const std::string& text, void (*read)(TomlTable&)) {
  return message_of([&] {
    TomlTable table = TomlTable::parse(text, "a.toml");
    read(table);
    table.finish();
  });
}

void read_travel(TomlTable& table) { table.numbers("travel", Quantity::length, 2); }
void read_range(TomlTable& table) { table.number("range", Quantity::length); }

TEST(TomlTable, ReadsUnitsIntoMillimetreAndRadianExactly) {
  TomlTable table = TomlTable::parse(
      "a_um = 2.5\nb_m = 1.5\nc_mm = 1_000\nd_deg = 180\ne_urad = -0.3\n\"ü\" = 1\nf_um=[ 0.3 ,-1e-3]\n", "a.toml");
  EXPECT_EQ(table.number("a", Quantity::length), 0.0025);
  EXPECT_EQ(table.number("b", Quantity::length), 1500);
  EXPECT_EQ(table.number("c", Quantity::length), 1000);
  EXPECT_DOUBLE_EQ(table.number("d", Quantity::angle), 3.14159265358979323846);
  EXPECT_EQ(table.number("e", Quantity::angle), -0.3e-6);
  EXPECT_EQ(table.numbers("f", Quantity::length, 2), (std::vector<double>{0.0003, -1e-6}));
  EXPECT_EQ(table.number("ü", Quantity::dimensionless), 1);
  table.finish();
}

TEST(TomlTable, AcceptsByteOrderMarkAndCarriageReturns) {
  TomlTable table = TomlTable::parse("\xEF\xBB\xBF# comment\r\nname = \"x\"\r\nrange_um = 5\r\n", "a.toml");
  EXPECT_EQ(table.text("name"), "x");
  EXPECT_EQ(table.number("range", Quantity::length), 0.005);
  table.finish();
}

TEST(TomlTable, RefusesNamesThatFilesCannotHave) {
  const std::string message =
      "a.toml:1:1: name: cannot be the name of a file; expected 1 to 100 bytes without \"/\" and control characters, "
      "no dot "
      "in front";
  for (const std::string& name : {std::string("../victim"), std::string("a/b"), std::string(".hidden"),
                                  std::string("a\\tb"), std::string(), std::string(101, 'a')}) {
    EXPECT_EQ(message_of_toml("name = \"" + name + "\"\n", [](TomlTable& table) { table.file_name("name"); }), message)
        << name;
  }
  EXPECT_EQ(message_of_toml("x = 1\nname = \"a\\u001bb\"\n", [](TomlTable& table) { table.file_name("name"); }),
            "a.toml:2:8: name: has control characters in it; expected a text on one line");
  TomlTable table = TomlTable::parse("name = \"L\u00e4nge 2.x\"\n", "a.toml");
  EXPECT_EQ(table.file_name("name"), "L\u00e4nge 2.x");
}

TEST(TomlTable, NamesTheUnitsThatWouldHaveBeenRight) {
  EXPECT_EQ(message_of_toml("\ntravel_kg = [0, 1]\n", read_travel),
            "a.toml:2:1: travel_kg: 'kg' is not a unit of a length; expected travel_mm, travel_um or travel_m");
  EXPECT_EQ(message_of_toml("travel = [0, 1]\n", read_travel),
            "a.toml:1:1: travel: the unit is missing from the name; expected travel_mm, travel_um or travel_m");
  EXPECT_EQ(message_of_toml("travel_deg = [0, 1]\n", read_travel),
            "a.toml:1:1: travel_deg: 'deg' is not a unit of a length; expected travel_mm, travel_um or travel_m");
  EXPECT_EQ(message_of_toml("range_mm = 1\nrange_um = 1\n", read_range),
            "a.toml:2:1: range_um: is given together with range_mm; expected only one of them");
}

TEST(TomlTable, RefusesNumbersThatAreNone) {
  EXPECT_EQ(message_of_toml("travel_mm = [0, nan]", read_travel),
            "a.toml:1:17: travel_mm[2]: nan is not a finite number; expected a length in mm");
  EXPECT_EQ(message_of_toml("range_um = -inf", read_range),
            "a.toml:1:12: range_um: -inf is not a finite number; expected a length in um");
  EXPECT_EQ(message_of_toml("range_um = 1e308", read_range),
            "a.toml:1:12: range_um: 1e308 is too large; expected a length in um, at most 1e9 mm");
  EXPECT_EQ(message_of_toml("range_mm = \"5\"", read_range),
            "a.toml:1:12: range_mm: is not a number; expected a length in mm");
  EXPECT_EQ(message_of_toml("range_mm = true", read_range),
            "a.toml:1:12: range_mm: is not a number; expected a length in mm");
  EXPECT_EQ(message_of_toml("travel_mm = 5", read_travel),
            "a.toml:1:13: travel_mm: is not an array; expected an array of 2 numbers in mm");
  EXPECT_EQ(message_of_toml("travel_mm = [1, 2, 3]", read_travel),
            "a.toml:1:13: travel_mm: has 3 elements; expected an array of 2 numbers in mm");
}

TEST(TomlTable, RefusesUnknownKeysWithTheNearestSpelling) {
  EXPECT_EQ(message_of_toml("range_mm = 1\nnmae = \"x\"\n",
                            [](TomlTable& table) {
                              read_range(table);
                              table.text_or("name", "");
                            }),
            "a.toml:2:1: nmae: unknown key, did you mean name?");
  EXPECT_EQ(message_of_toml("range_mm = 1\nzebra = 1\n", read_range), "a.toml:2:1: zebra: unknown key");
}

TEST(TomlTable, SaysWhatIsMissing) {
  EXPECT_EQ(message_of_toml("name = \"x\"", read_range),
            "a.toml:1:1: range_mm: missing; expected a length (range_mm, range_um or range_m)");
  EXPECT_EQ(message_of_toml("[t]\n", [](TomlTable& table) { table.table("t").text("name"); }),
            "a.toml:1:1: t.name: missing; expected a text in quotes");
}

TEST(TomlTable, ReportsTheParsersPlace) {
  EXPECT_EQ(message_of_toml("", read_range), "a.toml: the file is empty");
  EXPECT_EQ(message_of_toml("\xEF\xBB\xBF \r\n", read_range), "a.toml: the file is empty");
  const std::string twice = message_of_toml("a = 1\na = 2\n", read_range);
  EXPECT_TRUE(twice.starts_with("a.toml:2:")) << twice;
  const std::string comma = message_of_toml("a = 1\nrange_mm = 1,5\n", read_range);
  EXPECT_TRUE(comma.starts_with("a.toml:2:")) << comma;
}

TEST(TomlTable, SaysWhatAFileOfAnotherFormatIsReadAs) {
  const auto message = [](const std::string& text, const std::string& file) {
    return message_of([&] { TomlDocument(text, file); });
  };
  const std::string readings = "x_mm,y_mm,z_mm\n1,2,3\n", hint = "a TOML file, whose name usually ends in .toml";
  EXPECT_THAT(message(readings, "runs.v2/readings.csv"), testing::EndsWith("; expected " + hint));
  EXPECT_THAT(message("# Title\nwhat \xC3\xA9 is = 1\n", "README.md"), testing::EndsWith("in quotes; " + hint));
  for (const char* file : {"a.study.toml", "study", "runs.v2/study"}) {
    EXPECT_THAT(message(readings, file), testing::Not(testing::HasSubstr(hint)));
  }
}

// Found by fuzzing: toml++ 3.3 asserts on these.
TEST(TomlTable, RefusesHeadersWithoutNameAndStrayCharacters) {
  const std::string expected = "; expected a name of letters, digits, _ and -, or a text in quotes";
  EXPECT_EQ(message_of_toml("a = 1\n[= \"t\"\n", read_range), "a.toml:2:2: a table header without a name" + expected);
  EXPECT_EQ(message_of_toml("[[\t\x01x]]\n", read_range), "a.toml:1:4: a table header without a name" + expected);
  EXPECT_EQ(message_of_toml("a = \"ü\" \xC3\xBC", read_range),
            "a.toml:1:9: a character that may stand in texts and comments only" + expected);
  EXPECT_EQ(message_of_toml("\xC3\xBC = 1", read_range),
            "a.toml:1:1: a character that may stand in texts and comments only" + expected);
  EXPECT_EQ(message_of_toml("a = 0\"\xC3\xBC\"", read_range),
            "a.toml:1:6: a quote in the middle of a word; expected =, a comma or a blank before it");
  EXPECT_EQ(message_of_toml("a = 0.\"\xC3\xBC\"", read_range),
            "a.toml:1:7: a quote in the middle of a word; expected =, a comma or a blank before it");
  EXPECT_EQ(message_of_toml("\"\"\"\xC3\xBC", read_range), "a.toml:1:1: a text of several lines as a name" + expected);
  EXPECT_EQ(message_of_toml("a = 0\x01", read_range),
            "a.toml:1:6: a character that may stand in texts and comments only" + expected);
  EXPECT_EQ(message_of_toml("a = { b = [} }", read_range),
            "a.toml:1:12: a bracket that closes another kind; expected ]");
  EXPECT_EQ(message_of_toml("a = [2026-01-01 8]", read_range),
            "a.toml:1:6: a date; expected a number, or a text in quotes");
  EXPECT_EQ(message_of_toml("a = 20_26-01-01 8", read_range),
            "a.toml:1:5: a date; expected a number, or a text in quotes");
  EXPECT_EQ(message_of_toml("a = [0, 80-0-Q1-(e 8]", read_range),
            "a.toml:1:9: a date; expected a number, or a text in quotes");
}

TEST(TomlTable, AcceptsAnyCharacterInTextsAndCommentsAndNestedArrays) {
  TomlTable table = TomlTable::parse(
      "a = \"\"\"ü\" \\\"\"\" x\"\"\"\"\" # ü\nb = '''ü''' # \"\nc = 'ü\\' # ü\nd = \"ü\\\"ü\" # ü\n"
      "f = { g.\"ü\" = [\"ü\"], \"h\" = 'ü' }\ni.\"ü\".'j'=\"ü\"\ne_mm = [\n  # ü [\n  1,\n  2]\n\"ü\" = "
      "[\n[\"ü\"]\n]\n",
      "a.toml");
  EXPECT_EQ(table.text("a"), "ü\" \"\"\" x\"\"");
  EXPECT_EQ(table.text("b"), "ü");
  EXPECT_EQ(table.text("c"), "ü\\");
  EXPECT_EQ(table.text("d"), "ü\"ü");
  EXPECT_EQ(table.numbers("e", Quantity::length, 2), (std::vector<double>{1, 2}));
  EXPECT_TRUE(table.has("ü"));
  EXPECT_EQ(table.table("f").text("h"), "ü");
  EXPECT_EQ(table.table("i").table("ü").text("j"), "ü");
}

TEST(TomlTable, TextThatTheParserWouldMisreadIsRefused) {
  // Found by fuzzing: behind a wrong value or escape the parser meets a character that it cannot take.
  for (const char* text :
       {"a = +D[[[\"\xef\xbb\x9f\"", "a = [1$[['\xef\xbb\x9a']]", "a = \"\"\"x\\\xef\xbb\xb7\"\"\""}) {
    EXPECT_THROW(TomlTable::parse(text, "t.toml"), InputError) << text;
  }
}

}  // namespace
}  // namespace abbe
