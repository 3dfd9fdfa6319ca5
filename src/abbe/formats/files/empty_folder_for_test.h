#pragma once

// For tests that write files.
#include <gtest/gtest.h>

#include <filesystem>

namespace abbe::test {

/// A folder of that name with nothing in it.
inline std::filesystem::path empty_folder(const char* name) {
  std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / name;
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder;
}

}  // namespace abbe::test
