#pragma once

#include <sys/types.h>

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace abbe {

/// What a finished program left behind.
struct CommandResult {
  int exit_code = -1;      ///< 128 + signal number if a signal ended it
  std::string out;         ///< standard output
  std::string err;         ///< standard error
  bool signalled = false;  ///< run_and_signal: it was sent while the program still ran
};

/// Runs a program without a shell, with empty standard input, and waits for it.
///
/// @param program            path of the program
/// @param arguments          without the program's own name
/// @param working_directory  an existing folder; the program's current folder
/// @param environment        "NAME=value", added to or replacing the caller's environment
/// @throws std::system_error if the program cannot be started
CommandResult run_program(const std::string& program, const std::vector<std::string>& arguments,
                          const std::filesystem::path& working_directory,
                          const std::vector<std::string>& environment = {});

/// The same, but sends the program a signal as soon as `is_time` says so, which is asked several times per millisecond.
/// A program may end before: `signalled` says whether it did.
CommandResult run_and_signal(const std::string& program, const std::vector<std::string>& arguments,
                             const std::filesystem::path& working_directory, int signal,
                             const std::function<bool(pid_t)>& is_time);

/// An empty folder of its own for one test, removed at the end.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

  /// Writes a file, with the folders above it, and returns its path.
  std::filesystem::path write(const std::string& name, std::string_view text) const;

  /// The bytes of a file; fails the test if there is none.
  std::string read(const std::string& name) const;

 private:
  std::filesystem::path path_;
};

}  // namespace abbe
