#pragma once

#include <sys/types.h>

#include <filesystem>
#include <functional>
#include <mutex>

namespace abbe {

/// From now on SIGINT, SIGTERM and SIGHUP end the process with exit code 128 + their number (130 for Ctrl-C) after
/// everything unfinished has been removed. For main(), before any other thread is started.
///
/// A thread waits for the signals, which all others block; so that the removal is ordinary code and no half-done
/// operation is cut through. A signal that was ignored when the process began (nohup) stays ignored.
/// @param before  called first, on that thread: a message
void end_cleanly_when_interrupted(std::function<void(int signal)> before);

/// While it lives, an interruption waits: for steps that must be done together, such as making a file and noting it, or
/// two renames. Steps that take long do not belong here. Not to be nested.
class UninterruptedSteps {
 public:
  UninterruptedSteps();

 private:
  std::unique_lock<std::mutex> held_;
};

/// A file or folder that is removed, with all in it, if the process is interrupted while this lives. It is its owner's
/// to remove otherwise.
class UnfinishedPath {
 public:
  explicit UnfinishedPath(const std::filesystem::path& path);
  ~UnfinishedPath();
  UnfinishedPath(const UnfinishedPath&) = delete;
  UnfinishedPath& operator=(const UnfinishedPath&) = delete;

 private:
  std::filesystem::path path_;
};

/// Processes that are killed, before anything is removed, if this one is interrupted while this lives.
class UnfinishedProcesses {
 public:
  /// @param group  number of their process group, of which this process is no part
  explicit UnfinishedProcesses(pid_t group);
  ~UnfinishedProcesses();
  UnfinishedProcesses(const UnfinishedProcesses&) = delete;
  UnfinishedProcesses& operator=(const UnfinishedProcesses&) = delete;

 private:
  pid_t group_;
};

}  // namespace abbe
