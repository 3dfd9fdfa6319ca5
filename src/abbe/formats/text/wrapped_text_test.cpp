#include "abbe/formats/text/wrapped_text.h"

#include <gtest/gtest.h>

namespace abbe {
namespace {

TEST(WrappedHelp, KeepsLinesThatFit) {
  EXPECT_EQ(wrapped_help("", 10, "abbe "), "");
  EXPECT_EQ(wrapped_help("ten of us!\n\n  a b\n", 10, "abbe "), "ten of us!\n\n  a b\n");
}

TEST(WrappedHelp, PutsTheRestBelowTheSecondColumn) {
  EXPECT_EQ(wrapped_help("  -x NUM      one two three four five six", 30, "abbe "),
            "  -x NUM      one two three\n"
            "              four five six");
}

TEST(WrappedHelp, IndentsTheRestOfALineWithoutColumns) {
  EXPECT_EQ(wrapped_help("  one two three four\nnext", 12, "abbe "), "  one two\n    three\n    four\nnext");
}

TEST(WrappedHelp, ContinuesACommandAsShellsDo) {
  EXPECT_EQ(wrapped_help("  abbe run a.toml --output results", 22, "abbe "),
            "  abbe run a.toml \\\n"
            "      --output results");
  // The last word needs no room for a backslash.
  EXPECT_EQ(wrapped_help("abbe aaa bbb ccc", 12, "abbe "), "abbe aaa \\\n    bbb ccc");
}

TEST(WrappedHelp, KeepsALongWordWhole) {
  EXPECT_EQ(wrapped_help("aaaaaaaaaaaa b", 5, "abbe "), "aaaaaaaaaaaa\n  b");
  EXPECT_EQ(wrapped_help("aaaaaaaaaaaa", 5, "abbe "), "aaaaaaaaaaaa");
}

TEST(WrappedHelp, BreaksALongListBehindItsCommas) {
  EXPECT_EQ(wrapped_help("  {one,two,three,four}", 12, "abbe "), "  {one,two,\n    three,\n    four}");
  EXPECT_EQ(wrapped_help("  abbe a,b,c,d,e,f", 10, "abbe "), "  abbe \\\n      a,b,c,d,e,f") << "shells would not";
}

TEST(WrappedHelp, CountsCharactersAndNotBytes) {
  EXPECT_EQ(wrapped_help("\xC2\xB5m \xC2\xB5m \xC2\xB5m", 8, "abbe "), "\xC2\xB5m \xC2\xB5m \xC2\xB5m");
}

TEST(PrefixedLines, HaveThePrefixOnEach) {
  EXPECT_EQ(prefixed_lines("abbe: ", ""), "");
  EXPECT_EQ(prefixed_lines("abbe: ", "one\ntwo\n"), "abbe: one\nabbe: two\n");
  EXPECT_EQ(prefixed_lines("abbe: ", "one\ntwo"), "abbe: one\nabbe: two");
}

}  // namespace
}  // namespace abbe
