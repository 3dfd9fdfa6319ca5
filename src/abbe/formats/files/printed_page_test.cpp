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
  explicit PretendedBrowser(const std::string& script)
      : path_(std::filesystem::temp_directory_path() / ("abbe-browser-" + std::to_string(::getpid()))) {
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

TEST(PrintedPage, WithoutABrowserTheProblemSaysWhatToInstall) {
  const SetVariable none("ABBE_BROWSER", "");
  const SetVariable nowhere("PATH", "/nowhere");
  const PrintedPage printed = print_page("<p>text</p>", {});
  EXPECT_EQ(printed.pdf, "");
  EXPECT_THAT(printed.problem, HasSubstr("apt-get install chromium"));
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

TEST(PrintedPage, TheLargestTreeOfPagesCounts) {
  EXPECT_EQ(pdf_page_count("<</Type /Pages /Count 2>> endobj <</Type /Pages /Count 10>> endobj"), 10U);
  EXPECT_EQ(pdf_page_count("<</Type /Pages /Kids []>> endobj /Count 7"), 0U) << "of another object";
  EXPECT_EQ(pdf_page_count(""), 0U);
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

}  // namespace
}  // namespace abbe
