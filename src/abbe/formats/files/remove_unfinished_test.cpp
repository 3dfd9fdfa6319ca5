#include "abbe/formats/files/remove_unfinished.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <string>

#include "abbe/formats/files/empty_folder_for_test.h"
#include "abbe/formats/files/results_marker.h"

namespace abbe {
namespace {

namespace fs = std::filesystem;

/// @param mark  what says that it is ours
void make_unfinished(const fs::path& path, const char* mark = kBeingWritten) {
  fs::create_directories(path / "maps");
  std::ofstream(path / mark) << "";
  for (int i = 0; i < 30; ++i) {
    std::ofstream(path / (std::to_string(i) + ".csv")) << i;
    std::ofstream(path / "maps" / (std::to_string(i) + ".csv")) << i;
  }
}

TEST(RemoveUnfinished, RemovesFilesFoldersAndLinksButNotWhatLinksLeadTo) {
  const fs::path folder = test::empty_folder("abbe_remove_unfinished");
  std::ofstream(folder / "mine.txt") << "mine";
  fs::create_directory(folder / "mine");
  std::ofstream(folder / "mine/a.txt") << "mine";
  make_unfinished(folder / "u");
  fs::create_symlink(folder / "mine", folder / "u/folder");
  fs::create_symlink(folder / "mine.txt", folder / "u/file");
  remove_unfinished(folder / "u");
  EXPECT_FALSE(fs::exists(folder / "u"));
  std::ofstream(folder / "f") << "half";
  remove_unfinished(folder / "f");
  EXPECT_FALSE(fs::exists(folder / "f"));
  fs::create_directory_symlink(folder / "mine", folder / "link");
  remove_unfinished(folder / "link");
  EXPECT_FALSE(fs::exists(fs::symlink_status(folder / "link")));
  remove_unfinished(folder / "nothing");
  EXPECT_TRUE(fs::exists(folder / "mine/a.txt"));
  EXPECT_TRUE(fs::exists(folder / "mine.txt"));
}

TEST(RemoveUnfinished, WhatAKillLeavesIsKnownAsUnfinished) {
  const fs::path folder = test::empty_folder("abbe_remove_killed");
  const fs::path path = folder / "u";
  int left = 0;
  for (int i = 0; i < 300; ++i) {
    // Until it is whole, and in the moment before it gets its name.
    const char* mark = i % 3 == 0 ? ResultsMarker::kName : kBeingWritten;
    make_unfinished(path, mark);
    const pid_t child = ::fork();
    if (child == 0) {
      remove_unfinished(path);
      ::_exit(0);
    }
    ::usleep(static_cast<useconds_t>(50 + 7 * i % 900));
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    if (fs::exists(path) && !fs::is_empty(path)) {
      ++left;
      ASSERT_TRUE(fs::exists(path / mark)) << i;
    }
    remove_unfinished(path);
    ASSERT_FALSE(fs::exists(path)) << i;
  }
  EXPECT_GT(left, 0) << "no kill came while it was being removed";
}

}  // namespace
}  // namespace abbe
