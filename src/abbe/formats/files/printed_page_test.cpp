#include "abbe/formats/files/printed_page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <optional>

#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

using testing::HasSubstr;

/// A variable of the environment for one test.
class SetVariable {
 public:
  SetVariable(const char* name, const std::string& value) : name_(name) {
    if (const char* before = std::getenv(name)) before_ = before;
    ::setenv(name, value.c_str(), 1);
  }
  ~SetVariable() {
    if (before_) {
      ::setenv(name_, before_->c_str(), 1);
    } else {
      ::unsetenv(name_);
    }
  }
  SetVariable(const SetVariable&) = delete;
  SetVariable& operator=(const SetVariable&) = delete;

 private:
  const char* name_;
  std::optional<std::string> before_;
};

/// A program in place of the browser; gone with the object.
class PretendedBrowser {
 public:
  explicit PretendedBrowser(const std::string& script, const std::string& name = "abbe-browser")
      : path_(std::filesystem::temp_directory_path() / (name + "-" + std::to_string(::getpid()))) {
    std::ofstream(path_) << "#!/bin/sh\n" << script;
    std::filesystem::permissions(path_, std::filesystem::perms::owner_all);
  }
  ~PretendedBrowser() { std::filesystem::remove(path_); }
  PretendedBrowser(const PretendedBrowser&) = delete;
  PretendedBrowser& operator=(const PretendedBrowser&) = delete;

  std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

/// Writes its argument to the file that --print-to-pdf names.
std::string writing(const std::string& pdf) {
  return "for word; do case $word in --print-to-pdf=*) printf '" + pdf + "' > \"${word#*=}\";; esac; done\n";
}

/// Of what WeasyPrint is started with: the last argument is the file to write.
constexpr const char* kLastArgument = "for last; do :; done\n";

TEST(PrintedPage, WithoutAProgramTheProblemSaysWhatToInstall) {
  const SetVariable none("ABBE_BROWSER", "");
  const SetVariable nowhere("PATH", "/nowhere");
  const PrintedPage printed = print_page("<p>text</p>", {});
  EXPECT_EQ(printed.pdf, "");
  EXPECT_THAT(printed.problem, HasSubstr("apt-get install chromium"));
  EXPECT_THAT(printed.problem, HasSubstr("apt-get install weasyprint"));
}

TEST(PrintedPage, AVariableThatNamesNoProgramIsAnError) {
  const SetVariable wrong("ABBE_BROWSER", "/nowhere/chromium");
  EXPECT_THROW(print_page("", {}), InputError);
}

TEST(PrintedPage, ABrowserThatFailsOrWritesNoPdfIsNotBelieved) {
  {
    const PretendedBrowser browser("echo 'first' >&2; echo 'No usable sandbox!' >&2; exit 5\n");
    const SetVariable named("ABBE_BROWSER", browser.path());
    EXPECT_THAT(print_page("", {}).problem, HasSubstr("exit code 5 and printed no PDF: No usable sandbox!"));
  }
  for (const char* pdf : {"", "<html>", "%%PDF-1.4 /Type /Pages /Count 2 endobj"}) {
    const PretendedBrowser browser(writing(pdf));
    const SetVariable named("ABBE_BROWSER", browser.path());
    const PrintedPage printed = print_page("", {});
    EXPECT_THAT(printed.problem, HasSubstr("printed no PDF")) << pdf;
    EXPECT_EQ(printed.pdf, "") << pdf;
  }
}

TEST(PrintedPage, ABrowserThatHangsIsStopped) {
  const PretendedBrowser browser("exec sleep 60\n");
  const SetVariable named("ABBE_BROWSER", browser.path());
  EXPECT_THAT(print_page("", {.most_seconds = 0.2}).problem, HasSubstr("did not finish within 0.2 s"));
}

TEST(PrintedPage, PagesOfAWholeFileAreCounted) {
  const PretendedBrowser browser(writing("%%PDF-1.4\\n<</Type /Pages\\n/Count 3>> endobj\\n%%%%EOF\\n"));
  const SetVariable named("ABBE_BROWSER", browser.path());
  const PrintedPage printed = print_page("", {});
  EXPECT_EQ(printed.problem, "");
  EXPECT_EQ(printed.pages, 3U);
}

TEST(PrintedPage, ALanguageWithoutFontsIsRefused) {
  const PretendedBrowser browser(writing("%%PDF-1.4\\n<</Type /Pages\\n/Count 3>> endobj\\n%%%%EOF\\n"));
  const SetVariable named("ABBE_BROWSER", browser.path());
  const std::filesystem::path folder = browser.path() + "-fonts";
  std::filesystem::create_directory(folder);
  std::ofstream(folder / "fc-list") << "#!/bin/sh\n[ \"$1\" = :lang=zh-cn ] || echo Font\n";
  std::filesystem::permissions(folder / "fc-list", std::filesystem::perms::owner_all);
  const SetVariable path("PATH", folder.string() + ":/usr/bin:/bin");
  EXPECT_THAT(print_page("", {.language = "zh"}).problem, HasSubstr("language \"zh\" is installed"));
  EXPECT_EQ(print_page("", {.language = "ja"}).problem, "");
  EXPECT_EQ(print_page("", {.language = "de"}).problem, "");
  std::filesystem::remove_all(folder);
}

TEST(PrintedPage, WeasyPrintIsTakenWhereThereIsNoBrowser) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("abbe-printers-" + std::to_string(::getpid()));
  std::filesystem::create_directory(folder);
  const auto install = [&](const char* name) {
    std::ofstream(folder / name) << "#!/bin/sh\n";
    std::filesystem::permissions(folder / name, std::filesystem::perms::owner_all);
  };
  const SetVariable none("ABBE_BROWSER", "");
  const SetVariable path("PATH", folder.string());
  EXPECT_TRUE(find_page_printer().program.empty());
  install("weasyprint");
  EXPECT_EQ(find_page_printer().program, folder / "weasyprint");
  EXPECT_EQ(find_page_printer().kind, PagePrinter::Kind::weasyprint);
  install("google-chrome");
  EXPECT_EQ(find_page_printer().program, folder / "google-chrome");
  EXPECT_EQ(find_page_printer().kind, PagePrinter::Kind::browser);
  const SetVariable named("ABBE_BROWSER", (folder / "weasyprint").string());
  EXPECT_EQ(find_page_printer().kind, PagePrinter::Kind::weasyprint) << "where the variable names it";
  std::filesystem::remove_all(folder);
}

TEST(PrintedPage, WeasyPrintIsToldTheTimeAndWhereItsFilesBelong) {
  const PretendedBrowser program(std::string(kLastArgument) +
                                     "[ \"$SOURCE_DATE_EPOCH\" = 0 ] || exit 3\n"
                                     "[ \"$TMPDIR\" = \"${last%/page.pdf}\" ] || exit 4\n"
                                     "[ \"$(cat ${last%.pdf}.html)\" = '<p>text</p>' ] || exit 5\n"
                                     "printf '%%PDF-1.4\\n/CreationDate (20991231000000Z)\\n"
                                     "/Type /Pages /Count 2 endobj\\n%%%%EOF\\n' > \"$last\"\n",
                                 "weasyprint");
  const SetVariable named("ABBE_BROWSER", program.path());
  const SetVariable other("SOURCE_DATE_EPOCH", "12345");
  const PrintedPage printed = print_page("<p>text</p>", {.date = "20261128"});
  EXPECT_EQ(printed.problem, "");
  EXPECT_EQ(printed.pages, 2U);
  EXPECT_THAT(printed.pdf, HasSubstr("/CreationDate (D:20261128     )"));
}

TEST(PrintedPage, WhatAProgramLeavesRunningEndsWithIt) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("abbe-print-place-" + std::to_string(::getpid()));
  std::filesystem::create_directory(folder);
  {
    // A process of its own writes to the folder as long as it lives.
    const PretendedBrowser program(std::string(kLastArgument) +
                                       "printf '%%PDF-1.4 /Type /Pages /Count 1 endobj %%%%EOF' > \"$last\"\n"
                                       "(while true; do mkdir -p $TMPDIR/profile; echo > $TMPDIR/profile/x; done) &\n"
                                       "while [ ! -e $TMPDIR/profile/x ]; do sleep 0.01; done\n",
                                   "weasyprint");
    const SetVariable named("ABBE_BROWSER", program.path());
    const SetVariable temporary("TMPDIR", folder.string());
    EXPECT_EQ(print_page("", {}).problem, "");
  }
  ::usleep(50'000);
  EXPECT_TRUE(std::filesystem::is_empty(folder));
  std::filesystem::remove_all(folder);
}

TEST(PrintedPage, TheLargestTreeOfPagesCounts) {
  EXPECT_EQ(pdf_page_count("<</Type /Pages /Count 2>> endobj <</Type /Pages /Count 10>> endobj"), 10U);
  EXPECT_EQ(pdf_page_count("<</Type /Pages /Kids []>> endobj /Count 7"), 0U) << "of another object";
  EXPECT_EQ(pdf_page_count(""), 0U);
}

TEST(PrintedPage, PagesArePackedByNewerVersionsOfWeasyPrint) {
  // zlib of "1 0 2 40 <</Type /Pages/Kids [6 0 R 8 0 R 10 0 R]/Count 7>> <</Type /Catalog>>".
  static constexpr char kPacked[] =
      "\x78\x9c\x33\x54\x30\x50\x30\x52\x30\x31\x50\xb0\xb1\xd1\x0f\xa9\x2c\x48\x55\xd0\x0f\x48\x4c\x4f"
      "\x2d\xd6\xf7\xce\x4c\x29\x56\x88\x36\x03\xca\x06\x29\x58\x80\x49\x43\x03\x10\x15\xab\xef\x9c\x5f"
      "\x9a\x57\xa2\x60\x6e\x67\x87\xd0\xe2\x9c\x58\x92\x98\x93\x9f\x6e\x67\x07\x00\x08\xc3\x14\xe1";
  const std::string packed(kPacked, sizeof kPacked - 1);
  const std::string head = "%PDF-1.7\n9 0 obj\n<</Type /ObjStm/N 2/First 9/Filter /FlateDecode/Length 80>>\nstream\n";
  EXPECT_EQ(pdf_page_count(head + packed + "\nendstream\nendobj\n%%EOF"), 7U);
  EXPECT_EQ(pdf_page_count(head + "damaged" + "\nendstream\nendobj\n%%EOF"), 0U);
  EXPECT_EQ(pdf_page_count(head + packed), 0U) << "without its end";
}

TEST(PrintedPage, DatesAreReplacedWithoutMovingAnything) {
  const std::string made = "<</CreationDate (D:20991231235959+00'00')\n/ModDate (D:20991231235959+00'00')>>";
  std::string dated = made, undated = made;
  set_pdf_date("20261128", dated);
  EXPECT_EQ(dated, "<</CreationDate (D:20261128000000+00'00')\n/ModDate (D:20261128000000+00'00')>>");
  set_pdf_date("", undated);
  EXPECT_EQ(undated.size(), made.size());
  EXPECT_EQ(undated.find("2099"), std::string::npos);
  EXPECT_EQ(undated.find("Date"), std::string::npos);
}

TEST(PrintedPage, DatesOfWeasyPrintGetTheirPrefixAndAsMuchAsThereIsRoomFor) {
  std::string pdf = "/CreationDate (20991231235959+00'00)/ModDate (D:20991231)/Title (20991231)/CreationDate (2099)";
  set_pdf_date("20261128", pdf);
  EXPECT_EQ(pdf, "/CreationDate (D:20261128000000    )/ModDate (D:20261128)/Title (20991231)/CreationDate (2099)");
}

TEST(PrintedPage, NodesHaveTheSameNumbersWhateverTheBrowserCountedBefore) {
  std::string quiet =
      "/ID (node00000053)>> /Headers [(node00000053) (node00000079)] (node0000005) (node000000534) (node";
  std::string busy =
      "/ID (node00000056)>> /Headers [(node00000056) (node00000101)] (node0000005) (node000000534) (node";
  number_pdf_nodes(quiet);
  number_pdf_nodes(busy);
  EXPECT_EQ(quiet, "/ID (node00000001)>> /Headers [(node00000001) (node00000002)] (node0000005) (node000000534) (node");
  EXPECT_EQ(busy, quiet);
}

}  // namespace
}  // namespace abbe
