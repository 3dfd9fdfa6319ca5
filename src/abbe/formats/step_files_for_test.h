#pragma once

// For tests: STEP files with known sizes.
#include <filesystem>

namespace abbe::test {

inline std::filesystem::path golden_step_file(const char* name) {
  return std::filesystem::path(ABBE_GOLDEN) / "step" / name;
}

}  // namespace abbe::test
