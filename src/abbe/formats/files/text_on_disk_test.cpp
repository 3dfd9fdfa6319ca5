#include "abbe/formats/files/text_on_disk.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <functional>
#include <iterator>
#include <string>
#include <utility>

#include "abbe/formats/files/empty_folder_for_test.h"
#include "abbe/formats/files/results_folder.h"
#include "abbe/formats/files/text_file.h"
#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

namespace fs = std::filesystem;

/// The text as a file of results that are written.
std::string in_results(TextOnDisk text, const fs::path& folder) {
  ResultsFolder results(folder / "results");
  results.write("a.txt", std::move(text));
  results.commit();
  return read_text_file(folder / "results/a.txt");
}

bool has_no_entry(const fs::path& folder) { return fs::directory_iterator(folder) == fs::directory_iterator(); }

TEST(TextOnDisk, GetsANameWithItsResults) {
  const fs::path folder = test::empty_folder("abbe_text_on_disk");
  TextOnDisk text(folder / "new/results");
  std::string expected;
  for (int i = 0; i < 1000; ++i) {
    const std::string line = "line " + std::to_string(i) + std::string(1000, '.') + "\n";
    expected += line;
    text.append(line);
  }
  EXPECT_TRUE(has_no_entry(folder)) << "it has no name yet";
  ResultsFolder results(folder / "new/results");
  results.write("a.txt", "one");
  results.write("tables/b.txt", std::move(text));
  EXPECT_FALSE(fs::exists(folder / "new/results"));
  results.commit();
  EXPECT_EQ(read_text_file(folder / "new/results/tables/b.txt"), expected);
  EXPECT_EQ(fs::status(folder / "new/results/tables/b.txt").permissions(),
            fs::status(folder / "new/results/a.txt").permissions());
}

TEST(TextOnDisk, BeginsAgain) {
  const fs::path folder = test::empty_folder("abbe_text_again");
  TextOnDisk text(folder / "results");
  const std::function<void(std::string)> take = text.taker();
  text.append("what does not count");
  text.clear();
  take("nor this");
  take("");
  take("what ");
  text.append("counts");
  EXPECT_EQ(in_results(std::move(text), folder), "what counts");
}

TEST(TextOnDisk, LeavesNothingIfItGetsNoName) {
  const fs::path folder = test::empty_folder("abbe_text_without_name");
  {
    TextOnDisk text(folder / "results");
    text.append("text");
  }
  EXPECT_TRUE(has_no_entry(folder));
}

TEST(TextOnDisk, IsOnTheSameDiskAsItsResultsOrCopied) {
  const fs::path folder = test::empty_folder("abbe_text_elsewhere");
  TextOnDisk text("/dev/shm/results");
  text.append("text");
  EXPECT_EQ(in_results(std::move(text), folder), "text");
}

TEST(TextOnDisk, ADiskThatIsFullIsSaidWithTheNameOfTheFile) {
  const fs::path folder = test::empty_folder("abbe_text_full");
  const pid_t child = ::fork();
  if (child == 0) {
    const rlimit limit{10000, 10000};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    std::signal(SIGXFSZ, SIG_IGN);
    TextOnDisk text(folder / "results");
    for (int i = 0; i < 100; ++i) text.append(std::string(1000, '.'));
    int code = 1;
    try {
      ResultsFolder results(folder / "results");
      results.write("a.txt", std::move(text));
    } catch (const InputError& error) {
      const std::string message = error.what();
      code = message.find("a.txt") != std::string::npos && message.find("File too large") != std::string::npos ? 0 : 2;
    }
    ::_exit(code);
  }
  int status = -1;
  ::waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
  EXPECT_TRUE(has_no_entry(folder));
}

}  // namespace
}  // namespace abbe
