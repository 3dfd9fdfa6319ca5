#include "abbe/formats/results_folder.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "abbe/formats/empty_folder_for_test.h"
#include "abbe/formats/input_error.h"
#include "abbe/formats/message_of.h"
#include "abbe/formats/streamed_file.h"

namespace abbe {
namespace {

namespace fs = std::filesystem;

std::string contents(const fs::path& path) {
  std::ifstream stream(path);
  std::stringstream text;
  text << stream.rdbuf();
  return text.str();
}

std::size_t entries(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

void write_result(const fs::path& name, const std::string& text) {
  ResultsFolder results(name);
  results.write("summary.json", text);
  results.write("maps/a.csv", text + text);
  results.commit();
}

/// Status of a child process that runs the action and ends.
template <typename Action>
int status_of_child(Action&& action) {
  const pid_t child = ::fork();
  if (child == 0) {
    action();
    ::_exit(0);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return status;
}

TEST(ResultsFolder, AppearsWholeAndReplacesTheOldOne) {
  const fs::path folder = test::empty_folder("abbe_results");
  write_result(folder / "r", "one");
  EXPECT_EQ(contents(folder / "r/summary.json"), "one");
  write_result(folder / "r/", "two");
  EXPECT_EQ(contents(folder / "r/summary.json"), "two");
  EXPECT_EQ(contents(folder / "r/maps/a.csv"), "twotwo");
  EXPECT_EQ(entries(folder), 1U);
}

TEST(ResultsFolder, LeavesNothingWithoutCommit) {
  const fs::path folder = test::empty_folder("abbe_uncommitted");
  write_result(folder / "r", "one");
  {
    ResultsFolder results(folder / "r");
    results.write("summary.json", "two");
    EXPECT_EQ(contents(folder / "r/summary.json"), "one");
  }
  EXPECT_EQ(contents(folder / "r/summary.json"), "one");
  EXPECT_EQ(entries(folder), 1U);
}

TEST(ResultsFolder, KilledWriterLeavesTheOldResultAndTheNextOneCleansUp) {
  const fs::path folder = test::empty_folder("abbe_killed");
  write_result(folder / "r", "one");
  const int status = status_of_child([&] {
    ResultsFolder results(folder / "r");
    results.write("summary.json", "half");
    ::raise(SIGKILL);
  });
  ASSERT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
  EXPECT_EQ(contents(folder / "r/summary.json"), "one");
  EXPECT_EQ(entries(folder), 2U);  // the old result and what the killed one left
  write_result(folder / "r", "three");
  EXPECT_EQ(contents(folder / "r/summary.json"), "three");
  EXPECT_EQ(entries(folder), 1U);
}

TEST(ResultsFolder, WriterKilledAtAnyMomentLeavesAWholeResult) {
  const fs::path folder = test::empty_folder("abbe_killed_anywhere");
  write_result(folder / "r", "0");
  int killed = 0;
  for (int i = 0; i < 40; ++i) {
    const pid_t child = ::fork();
    if (child == 0) {
      for (int k = 0;; ++k) write_result(folder / "r", std::to_string(k));
    }
    ::usleep(static_cast<useconds_t>(200 * (i + 1)));
    ::kill(child, SIGKILL);
    int status = 0;
    ::waitpid(child, &status, 0);
    killed += WIFSIGNALED(status);
    const std::string text = contents(folder / "r/summary.json");
    ASSERT_FALSE(text.empty());
    ASSERT_EQ(contents(folder / "r/maps/a.csv"), text + text);
  }
  EXPECT_EQ(killed, 40);
}

TEST(ResultsFolder, FullDiskLeavesTheOldResult) {
  const fs::path folder = test::empty_folder("abbe_full");
  write_result(folder / "r", "one");
  write_result(folder / "s", "one");
  // A limit on the size of files stands for the full disk: with the signal ignored write() fails, else the process
  // dies.
  for (const bool ignored : {true, false}) {
    const fs::path name = folder / (ignored ? "r" : "s");
    const int status = status_of_child([&] {
      ::signal(SIGXFSZ, ignored ? SIG_IGN : SIG_DFL);
      const rlimit limit{10000, 10000};
      ::setrlimit(RLIMIT_FSIZE, &limit);
      try {
        write_result(name, std::string(20000, 'x'));
      } catch (const InputError& error) {
        ::_exit(std::string(error.what())
                            .find("summary.json: cannot be written: File too large; expected a writable "
                                  "folder with enough space") != std::string::npos
                    ? 7
                    : 8);
      }
    });
    if (ignored) {
      ASSERT_TRUE(WIFEXITED(status));
      EXPECT_EQ(WEXITSTATUS(status), 7);
    } else {
      EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGXFSZ);
    }
    EXPECT_EQ(contents(name / "summary.json"), "one");
    EXPECT_EQ(contents(name / "maps/a.csv"), "oneone");
  }
}

TEST(ResultsFolder, SaysWhyItCannotBeMade) {
  const fs::path folder = test::empty_folder("abbe_no_folder");
  std::ofstream(folder / "file") << "x";
  EXPECT_EQ(message_of([&] { ResultsFolder results(folder / "file"); }),
            (folder / "file").string() + ": is a file; expected a folder for results");
  const std::string message = message_of([&] { ResultsFolder results(folder / "file/r"); });
  EXPECT_NE(message.find("cannot be written: "), std::string::npos) << message;
}

TEST(ResultsFolder, AFolderWithOtherFilesIsNotReplaced) {
  const fs::path folder = test::empty_folder("abbe_foreign");
  fs::create_directories(folder / "r/measured");
  const std::string refused = (folder / "r").string() +
                              ": holds files that are no results of abbe; expected a new or empty folder, or one with "
                              "results, which are replaced";
  EXPECT_EQ(message_of([&] { write_result(folder / "r", "one"); }), refused);
  std::ofstream(folder / "r/keep.txt") << "mine";
  EXPECT_EQ(message_of([&] { write_result(folder / "r/", "one"); }), refused);
  EXPECT_EQ(contents(folder / "r/keep.txt"), "mine");
  fs::remove_all(folder / "r");
  fs::create_directories(folder / "r");
  write_result(folder / "r", "one");  // empty
  fs::remove(folder / "r/summary.json");
  write_result(folder / "r", "two");  // known by its marker
  EXPECT_EQ(contents(folder / "r/summary.json"), "two");
}

TEST(AtomicFile, ReplacesOrLeavesTheOldOne) {
  const fs::path folder = test::empty_folder("abbe_atomic");
  write_file_atomically(folder / "a.txt", "one");
  write_file_atomically(folder / "a.txt", "two");
  EXPECT_EQ(contents(folder / "a.txt"), "two");
  const int status = status_of_child([&] {
    ::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{10000, 10000};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    try {
      write_file_atomically(folder / "a.txt", std::string(20000, 'x'));
    } catch (const InputError&) {
      ::_exit(7);
    }
  });
  EXPECT_EQ(WEXITSTATUS(status), 7);
  EXPECT_EQ(contents(folder / "a.txt"), "two");
  EXPECT_EQ(entries(folder), 1U);
}

TEST(AtomicFile, DevicesPipesAndFoldersAreNotReplaced) {
  const fs::path folder = test::empty_folder("abbe_no_files");
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  fs::create_symlink("/dev/null", folder / "device");
  fs::create_directory(folder / "folder");
  for (const char* const name : {"pipe", "device"}) {
    const std::string refused =
        (folder / name).string() + ": is a device, a pipe or a socket; expected the name of a file to write";
    EXPECT_EQ(message_of([&] { write_file_atomically(folder / name, "x"); }), refused);
    EXPECT_EQ(message_of([&] { StreamedFile file(folder / name); }), refused);
  }
  EXPECT_NE(message_of([&] { write_file_atomically(folder / "folder", "x"); }).find("Is a directory"),
            std::string::npos);
  EXPECT_TRUE(fs::is_fifo(folder / "pipe"));
  EXPECT_TRUE(fs::is_symlink(folder / "device"));
  EXPECT_EQ(entries(folder), 3U);
}

TEST(AtomicFile, ThroughALinkTheFileIsWritten) {
  const fs::path folder = test::empty_folder("abbe_linked");
  fs::create_directory(folder / "elsewhere");
  fs::create_symlink("elsewhere/a.txt", folder / "link");
  std::ofstream(folder / "elsewhere/a.txt") << "old";
  write_file_atomically(folder / "link", "one");
  EXPECT_EQ(contents(folder / "elsewhere/a.txt"), "one");
  StreamedFile file(folder / "link");
  file.append("two");
  file.commit();
  EXPECT_EQ(contents(folder / "elsewhere/a.txt"), "two");
  EXPECT_TRUE(fs::is_symlink(folder / "link"));
  EXPECT_EQ(entries(folder) + entries(folder / "elsewhere"), 3U);
}

TEST(AtomicFile, MessagesNameTheFileThatWasAskedFor) {
  const fs::path name = test::empty_folder("abbe_named") / "none" / "a.csv";
  EXPECT_EQ(
      message_of([&] { write_file_atomically(name, "x"); }),
      name.string() + ": cannot be written: No such file or directory; expected a writable folder with enough space");
}

}  // namespace
}  // namespace abbe
