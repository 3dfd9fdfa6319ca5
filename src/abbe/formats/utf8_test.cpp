#include "abbe/formats/utf8.h"

#include <gtest/gtest.h>

#include <string>

#include "abbe/formats/input_error.h"

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
}

TEST(InputError, SaysAllOfItWhateverIsInTheFile) {
  const std::string cell("1\0\x1b", 3);
  const InputError error({"q.csv", 23, 8, std::string(100000, 'y')}, "'" + cell + "' is not a number",
                         "a length in mm");
  const std::string message = error.what();
  EXPECT_TRUE(message.starts_with("q.csv:23:8: yyy")) << message;
  EXPECT_TRUE(message.ends_with("...: '1\\x00\\x1b' is not a number; expected a length in mm")) << message;
  EXPECT_LT(message.size(), 300U);
}

}  // namespace
}  // namespace abbe
