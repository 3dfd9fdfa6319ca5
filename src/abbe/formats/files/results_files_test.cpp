#include "abbe/formats/files/results_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "abbe/formats/files/empty_folder_for_test.h"
#include "abbe/formats/text/message_of.h"

namespace abbe {
namespace {

using testing::HasSubstr;

TEST(ResultsFiles, AreThoseOfTheResultsUnlessOthersAreNamed) {
  const std::string results = test::empty_folder("results").string();
  std::ofstream(results + "/machine.toml") << "name = \"mill\"\n";
  EXPECT_EQ(file_or_of_results("", results, "machine.toml", "--machine"), results + "/machine.toml");
  EXPECT_EQ(file_or_of_results("other.toml", results, "machine.toml", "--machine"), "other.toml");
  EXPECT_THAT(message_of([&] { file_or_of_results("", results, "errors.toml", "--errors"); }),
              HasSubstr("errors.toml: these results have no such file; expected results of a simulated study, or "
                        "--errors with a file"));
  EXPECT_THAT(message_of([] { file_or_of_results("", "", "machine.toml", "--machine"); }),
              HasSubstr("--machine: is missing"));
  EXPECT_EQ(results_summary_text(results), "");
  EXPECT_EQ(results_summary_text(""), "");
  std::ofstream(results + "/summary.json") << "{}";
  EXPECT_EQ(results_summary_text(results), "{}");
  require_results(results);
  require_results("");
  EXPECT_THAT(message_of([&] { require_results(results + "/machine.toml"); }), HasSubstr("is not a folder"));
}

}  // namespace
}  // namespace abbe
