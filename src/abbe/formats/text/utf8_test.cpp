#include "abbe/formats/text/utf8.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>

#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

TEST(Utf8, SequencesHaveTheirLengthAndOtherBytesHaveNone) {
  EXPECT_EQ(utf8_length("a", 0), 1U);
  EXPECT_EQ(utf8_length("\u00b5m", 0), 2U);
  EXPECT_EQ(utf8_length("\u2212", 0), 3U);
  EXPECT_EQ(utf8_length("\U0001F600", 0), 4U);
  for (const char* const none : {"\x80", "\xC0\x80", "\xC2", "\xE0\x80\x80", "\xED\xA0\x80", "\xF0\x80\x80\x80",
                                 "\xF4\x90\x80\x80", "\xF5\x80\x80\x80", "\xFF"}) {
    EXPECT_EQ(utf8_length(none, 0), 0U) << none;
  }
}

TEST(Utf8, WhatATerminalWouldObeyIsShownAsNumbers) {
  EXPECT_EQ(printable("5 \u00b5m in X\n", 100), "5 \u00b5m in X\n");
  EXPECT_EQ(printable(std::string("a\0b\x1b[2J\x7f\xff\xc2\x9b", 11), 100), "a\\x00b\\x1b[2J\\x7f\\xff\\xc2\\x9b");
  EXPECT_EQ(printable(std::string(200, 'x'), 10), "xxxxxxxxxx...");
  // What turns the direction of writing round, and separators of lines and paragraphs.
  EXPECT_EQ(printable("a\u202eb\u2066\u2028\u061c\u200f", 100),
            "a\\xe2\\x80\\xaeb\\xe2\\x81\\xa6\\xe2\\x80\\xa8\\xd8\\x9c\\xe2\\x80\\x8f");
  EXPECT_EQ(printable("a\tb\nc", 100, LineFeeds::escaped), "a\tb\\x0ac");
}

TEST(Utf8, TextInPiecesIsShownAsInOne) {
  const std::string text = "5 \u00b5m \u2212 \U0001F600 \x1b[31m \xff \xe2\x80 x \u202e \xf0\x9f";
  for (std::size_t size = 1; size < 8; ++size) {
    PrintableText pieces;
    std::string shown;
    for (std::size_t at = 0; at < text.size(); at += size)
      shown += pieces.next(std::string_view(text).substr(at, size));
    EXPECT_EQ(shown + pieces.rest(), printable(text, text.size())) << size;
  }
}

TEST(Utf8, ANameHasNoControlCharacterButTheTab) {
  EXPECT_FALSE(has_control_character("\u00e4 b\t\xff \u202e"));
  for (const char* const name : {"a\nb", "\x1b[0m", "\r", "\x7f", "\u0085"}) EXPECT_TRUE(has_control_character(name));
}

TEST(InputError, SaysAllOfItWhateverIsInTheFile) {
  const std::string cell("1\0\x1b", 3);
  const InputError error({"q.csv", 23, 8, std::string(100000, 'y')}, fmt::format("'{}' is not a number", cell),
                         "a length in mm");
  const std::string message = error.what();
  EXPECT_TRUE(message.starts_with("q.csv:23:8: yyy")) << message;
  EXPECT_TRUE(message.ends_with("...: '1\\x00\\x1b' is not a number; expected a length in mm")) << message;
  EXPECT_LT(message.size(), 300U);
  EXPECT_STREQ(InputError({.file = "a\nb.csv", .field = "c\nd"}, "e").what(), "a\\x0ab.csv: c\\x0ad: e");
}

}  // namespace
}  // namespace abbe
