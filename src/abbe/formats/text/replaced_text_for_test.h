#pragma once

// For tests: texts with one part changed.
#include <gtest/gtest.h>

#include <string>

namespace abbe::test {

/// The text with another one in place of the first `from`; fails the test if there is none.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

}  // namespace abbe::test
