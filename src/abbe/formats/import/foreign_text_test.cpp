#include "abbe/formats/import/foreign_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "abbe/formats/files/temporary_file_for_test.h"
#include "abbe/formats/import/gzip_for_test.h"
#include "abbe/formats/text/message_of.h"

namespace abbe {
namespace {

using std::string_literals::operator""s;
using test::gzip_of;
using test::utf16_of;
using testing::HasSubstr;

std::string message_of_text(const std::string& bytes, const ForeignTextOptions& options = {}) {
  return message_of([&] { decode_foreign_text(bytes, "t.txt", options); });
}

TEST(ForeignTextEncoding, IsFoundFromTheBytes) {
  struct Case {
    std::string bytes, text;
    TextEncoding encoding;
    const char* reason;
  };
  const std::string table = "x;y\n1;2\n";
  for (const Case& one : {
           Case{table, table, TextEncoding::utf8, "all bytes are UTF-8"},
           Case{"\xEF\xBB\xBF" + table, table, TextEncoding::utf8, "byte order mark"},
           Case{"µm;°\n", "µm;°\n", TextEncoding::utf8, "all bytes are UTF-8"},
           Case{"\xFF\xFE" + utf16_of(table, false), table, TextEncoding::utf16_le, "byte order mark"},
           Case{"\xFE\xFF" + utf16_of(table, true), table, TextEncoding::utf16_be, "byte order mark"},
           Case{utf16_of(table, false), table, TextEncoding::utf16_le, "every second byte is zero"},
           Case{utf16_of(table, true), table, TextEncoding::utf16_be, "every other byte is zero"},
           Case{"x\n1 \xB5m \xE4 \x80\n", "x\n1 µm ä €\n", TextEncoding::windows_1252,
                "byte 0xB5 in line 2 is not UTF-8"},
       }) {
    const ForeignText read = decode_foreign_text(one.bytes, "t.txt");
    EXPECT_EQ(read.text, one.text);
    EXPECT_EQ(read.encoding, one.encoding) << one.text;
    EXPECT_EQ(read.reason, one.reason);
    EXPECT_FALSE(read.given);
  }
}

TEST(ForeignTextEncoding, PairsOfUtf16BecomeOneCharacter) {
  EXPECT_EQ(decode_foreign_text("\xFF\xFEx\0\x3D\xD8\x00\xDE"s, "t.txt").text, "x\xF0\x9F\x98\x80");
  EXPECT_EQ(message_of_text("\xFF\xFEx\0\n\0\x3D\xD8y\0"s),
            "t.txt:2: half of a pair of UTF-16 stands alone; expected a whole file of UTF-16");
  EXPECT_THAT(message_of_text("\xFF\xFEx\0\x3D\xD8"s), HasSubstr("stands alone"));
  EXPECT_THAT(message_of_text("\xFF\xFEx\0y"s), HasSubstr("half a character is left at the end"));
}

TEST(ForeignTextEncoding, ThatIsGivenIsTakenAndChecked) {
  const ForeignText read = decode_foreign_text("\xC2\xB5", "t.txt", {.encoding = TextEncoding::windows_1252});
  EXPECT_EQ(read.text, "Âµ");
  EXPECT_TRUE(read.given);
  EXPECT_EQ(message_of_text("a\nb\xB5\n", {.encoding = TextEncoding::utf8}),
            "t.txt:2: byte 0xB5 is not UTF-8; expected text in UTF-8");
  for (const std::string& name : encoding_names()) EXPECT_EQ(encoding_name(*encoding_named(name)), name);
  EXPECT_FALSE(encoding_named("latin-9"));
}

TEST(ForeignTextEncoding, WhatIsNoTextIsRefused) {
  EXPECT_THAT(message_of_text("x\n\x81\xFF\n"), HasSubstr("t.txt:2: byte 0x81 is neither UTF-8 nor Windows-1252"));
  EXPECT_THAT(message_of_text("x,y\n1,2,\0binary\n"s), HasSubstr("t.txt:2: a zero byte: this is not text"));
  EXPECT_THAT(message_of_text("\xFF\xFE\0\0x\0\0\0"s), HasSubstr("is UTF-32"));
  EXPECT_THAT(message_of_text(" \r\n\t\n"), HasSubstr("the file is empty"));
  EXPECT_THAT(message_of_text("\xEF\xBB\xBF"), HasSubstr("the file is empty"));
}

TEST(ForeignTextEncoding, LinesThatEndInCarriageReturnsAloneAreLines) {
  EXPECT_EQ(decode_foreign_text("x,y\r1,2\r", "t.txt").text, "x,y\n1,2\n");
  EXPECT_EQ(decode_foreign_text("x,y\r\n1,2\r\n", "t.txt").text, "x,y\r\n1,2\r\n");
}

TEST(ForeignTextGzip, IsUnpackedWhateverTheNameOfTheFile) {
  const test::TemporaryFile file(gzip_of("x;y\n") + gzip_of("1;2\n"), ".txt");
  const ForeignText read = read_foreign_text(file.path());
  EXPECT_EQ(read.text, "x;y\n1;2\n");
  EXPECT_TRUE(read.packed);
  EXPECT_EQ(decode_foreign_text(gzip_of("\xFF\xFE" + utf16_of("x\ty\n", false)), "t").text, "x\ty\n");
}

TEST(ForeignTextGzip, ThatIsDamagedOrTooLargeIsRefused) {
  const std::string packed = gzip_of("x;y\n1;2\n");
  // A member that ends where one byte is missing, anywhere.
  for (std::size_t length = 2; length < packed.size(); ++length) {
    EXPECT_THAT(message_of_text(packed.substr(0, length)), HasSubstr("cut short")) << length;
  }
  std::string wrong = packed;
  wrong[wrong.size() - 8] ^= 1;
  EXPECT_THAT(message_of_text(wrong), HasSubstr("the compressed data are damaged: incorrect data check"));
  EXPECT_THAT(message_of_text(packed + "tail"), HasSubstr("other bytes behind the compressed data"));
  EXPECT_EQ(decode_foreign_text(packed, "t", {.encoding = {}, .largest_unpacked = 8}).text.size(), 8U);
  EXPECT_EQ(message_of_text(packed, {.encoding = {}, .largest_unpacked = 7}),
            "t.txt: unpacks to more than 7 bytes; expected a smaller file, or one that is not compressed");
}

}  // namespace
}  // namespace abbe
