#pragma once

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/command_test.h"

namespace abbe {

/// `abbe evaluate` of something: what it answers for programs, and what it refuses.
class EvaluateTest : public CommandTest {
 protected:
  nlohmann::json json(std::vector<std::string> arguments, int expected_exit = ExitCode::done) const {
    arguments.insert(arguments.begin(), "evaluate");
    arguments.emplace_back("--json");
    const CommandResult result = abbe(arguments);
    EXPECT_EQ(result.exit_code, expected_exit) << result.err;
    return nlohmann::json::parse(result.out, nullptr, false);
  }
  void expect_refused(std::vector<std::string> arguments, const std::string& message) const {
    arguments.insert(arguments.begin(), "evaluate");
    const CommandResult result = abbe(arguments);
    EXPECT_EQ(result.exit_code, ExitCode::bad_input);
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(result.err, "abbe: " + message + "\n");
  }
  const std::string examples = std::string(ABBE_SOURCE_DIR "/examples/evaluate/");
};

}  // namespace abbe
