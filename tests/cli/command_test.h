#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "cli/run_command.h"

namespace abbe {

/// A test of the `abbe` command, in an empty folder of its own.
class CommandTest : public testing::Test {
 protected:
  /// Runs `abbe` in the test's folder.
  CommandResult abbe(const std::vector<std::string>& arguments,
                     const std::vector<std::string>& environment = {}) const {
    return run_program(ABBE_COMMAND, arguments, folder.path(), environment);
  }

  TemporaryFolder folder;
};

/// The exit codes of the command.
enum ExitCode : int { done = 0, computation_says_no = 1, bad_input = 2, internal_error = 3 };

}  // namespace abbe
