#include "abbe/formats/files/results_folder.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "abbe/formats/files/empty_folder_for_test.h"
#include "abbe/formats/files/streamed_file.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/message_of.h"

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

TEST(ResultsFolder, TakesFilesByNamesAndContents) {
  const fs::path folder = test::empty_folder("abbe_result_files");
  write_result_files(folder / "r", {{"a.json", "one"}, {"maps/b.csv", "two"}});
  EXPECT_EQ(contents(folder / "r/a.json"), "one");
  EXPECT_EQ(contents(folder / "r/maps/b.csv"), "two");
  EXPECT_THROW(write_result_files(folder / "r", {{"a.json", "three"}, {"../c", "four"}}), InputError);
  EXPECT_EQ(contents(folder / "r/a.json"), "one") << "whole or not at all";
  EXPECT_FALSE(fs::exists(folder / "c"));
  fs::remove_all(folder);
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

// Two writers and a kill of either at any moment, a thousand times, over a folder in which somebody keeps notes.
TEST(ResultsFolder, WritersKilledAtAnyMomentLoseNothing) {
  const fs::path folder = test::empty_folder("abbe_killed_anywhere");
  write_result(folder / "r", "0");
  fs::create_directory(folder / "r/notes");
  std::ofstream(folder / "r/notes/a.txt") << "mine";
  std::ofstream(folder / "r/maps/b.txt") << "mine too";
  int killed = 0;
  const auto start_writer = [&] {
    const pid_t child = ::fork();
    if (child != 0) return child;
    for (int k = 0;; ++k) {
      try {
        write_result(folder / "r", std::to_string(k));
      } catch (const InputError&) {
        // The other one has exchanged the folder in between: refused, and nothing is lost.
      }
    }
  };
  for (int i = 0; i < 500; ++i) {
    const pid_t writers[2] = {start_writer(), start_writer()};
    ::usleep(static_cast<useconds_t>(1000 + 37 * i % 6000));
    for (const pid_t writer : writers) {
      ::kill(writer, SIGKILL);
      int status = 0;
      ::waitpid(writer, &status, 0);
      killed += WIFSIGNALED(status);
    }
    // A kill between the exchange and the moving leaves the notes beside the results; the next writer brings them back.
    write_result(folder / "r", "whole");
    ASSERT_EQ(contents(folder / "r/summary.json"), "whole");
    ASSERT_EQ(contents(folder / "r/maps/a.csv"), "wholewhole");
    ASSERT_EQ(contents(folder / "r/notes/a.txt"), "mine") << i;
    ASSERT_EQ(contents(folder / "r/maps/b.txt"), "mine too") << i;
    ASSERT_EQ(entries(folder), 1U) << i;
  }
  EXPECT_EQ(killed, 1000);
}

TEST(ResultsFolder, ANewFolderInTheNameDoesNotHideWhereItLeads) {
  const fs::path folder = test::empty_folder("abbe_dots");
  fs::create_directory(folder / "mine");
  std::ofstream(folder / "mine/keep.txt") << "mine";
  EXPECT_THROW(ResultsFolder(folder / "new/../mine"), InputError);
  EXPECT_THROW(check_results_folder(folder / "new/../mine"), InputError);
  EXPECT_EQ(contents(folder / "mine/keep.txt"), "mine");
  write_result(folder / "new/../r", "one");
  write_result(folder / "r/../new/.././r/", "two");
  EXPECT_EQ(contents(folder / "r/summary.json"), "two");
  write_file_atomically(folder / "new/../a.txt", "one");
  EXPECT_EQ(contents(folder / "a.txt"), "one");
  EXPECT_EQ(entries(folder), 3U);  // no folder "new"
}

TEST(ResultsFolder, WhatAppearsWhileItIsWrittenIsNotReplaced) {
  const fs::path folder = test::empty_folder("abbe_appeared");
  ResultsFolder results(folder / "r");
  results.write("summary.json", "one");
  fs::create_directory(folder / "r");
  std::ofstream(folder / "r/keep.txt") << "mine";
  EXPECT_THROW(results.commit(), InputError);
  EXPECT_EQ(contents(folder / "r/keep.txt"), "mine");
  EXPECT_EQ(entries(folder / "r"), 1U);
}

TEST(ResultsFolder, FilesOfOthersStayWhereResultsAreReplaced) {
  const fs::path folder = test::empty_folder("abbe_notes");
  write_result(folder / "r", "one");
  std::ofstream(folder / "r/notes.txt") << "mine";
  fs::create_directories(folder / "r/pictures/old");
  std::ofstream(folder / "r/pictures/old/a.png") << "mine";
  std::ofstream(folder / "r/maps/notes.txt") << "mine";
  write_result(folder / "r", "two");
  EXPECT_EQ(contents(folder / "r/summary.json"), "two");
  for (const char* const name : {"notes.txt", "pictures/old/a.png", "maps/notes.txt"}) {
    EXPECT_EQ(contents(folder / "r" / name), "mine") << name;
  }
  EXPECT_EQ(entries(folder), 1U);
  // A result of that name would replace it.
  ResultsFolder results(folder / "r");
  results.write("notes.txt", "not mine");
  EXPECT_EQ(message_of([&] { results.commit(); }),
            (folder / "r/notes.txt").string() +
                ": is no result of abbe and would be replaced; expected another name for it, or another folder for the "
                "results");
  EXPECT_EQ(contents(folder / "r/notes.txt"), "mine");
}

TEST(ResultsFolder, FilesThatTheNextResultsDoNotHaveGo) {
  const fs::path folder = test::empty_folder("abbe_fewer");
  write_result(folder / "r", "one");
  ResultsFolder results(folder / "r");
  results.write("summary.json", "two");
  results.commit();
  EXPECT_FALSE(fs::exists(folder / "r/maps"));
  EXPECT_EQ(entries(folder), 1U);
}

TEST(ResultsFolder, LinksInOlderResultsAreNotFollowed) {
  const fs::path folder = test::empty_folder("abbe_links");
  write_result(folder / "r", "one");
  fs::rename(folder / "r/maps", folder / "moved");
  fs::create_directory_symlink(folder / "moved", folder / "r/maps");
  EXPECT_THROW(write_result(folder / "r", "two"), InputError);
  EXPECT_EQ(contents(folder / "r/summary.json"), "one");
  EXPECT_EQ(contents(folder / "moved/a.csv"), "oneone");
}

TEST(ResultsFolder, NamesStayInTheFolder) {
  const fs::path folder = test::empty_folder("abbe_names");
  ResultsFolder results(folder / "r");
  for (const char* const name : {"../victim", "a/../../victim", "/victim", "..", ""}) {
    EXPECT_THROW(results.write(name, "x"), InputError) << name;
  }
  EXPECT_FALSE(fs::exists(folder / "victim"));
}

TEST(ResultsFolder, WhatOthersCallAlikeStays) {
  const fs::path folder = test::empty_folder("abbe_alike");
  for (const char* const name : {"r.partial-999999", "r.old-999999", ".r.abbe-unfinished", ".r.0.abbe-older"}) {
    std::ofstream(folder / name) << "mine";
  }
  write_result(folder / "r", "one");
  write_file_atomically(folder / "r.csv", "one");
  EXPECT_EQ(entries(folder), 6U);
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
                              ": holds files that are not results of abbe; expected a new or empty folder, or one with "
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
  fs::remove(folder / "r/.abbe-results");
  EXPECT_EQ(message_of([&] { write_result(folder / "r", "one"); }), refused);  // anybody's summary.json
  EXPECT_EQ(contents(folder / "r/summary.json"), "two");
}

TEST(ResultsFolder, ResultsOfTheFirstVersionAreReplacedAsAWhole) {
  const fs::path folder = test::empty_folder("abbe_first_version");
  fs::create_directories(folder / "r/maps");
  std::ofstream(folder / "r/.abbe-results")
      << "Results of abbe: the next ones written here replace this folder as a whole.\n";
  std::ofstream(folder / "r/maps/gone.csv") << "old";
  write_result(folder / "r", "one");
  EXPECT_FALSE(fs::exists(folder / "r/maps/gone.csv"));
  EXPECT_EQ(contents(folder / "r/summary.json"), "one");
  EXPECT_EQ(entries(folder), 1U);
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
