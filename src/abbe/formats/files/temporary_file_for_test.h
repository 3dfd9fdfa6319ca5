#pragma once

// For tests: a file on the disk.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace abbe::test {

/// A file that is gone after the test; tests of one program may run side by side.
class TemporaryFile {
 public:
  TemporaryFile(const std::string& contents, const std::string& ending)
      : path_(std::filesystem::path(testing::TempDir()) /
              (std::string("abbe_") + testing::UnitTest::GetInstance()->current_test_info()->name() + ending)) {
    std::ofstream(path_, std::ios::binary) << contents;
  }
  ~TemporaryFile() { std::filesystem::remove(path_); }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace abbe::test
