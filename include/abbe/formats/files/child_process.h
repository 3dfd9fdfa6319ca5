#pragma once

// For formats and the command: a program that is run to its end.
#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace abbe {

/// A file in memory; gone with the object, even if the process is killed.
class MemoryFile {
 public:
  explicit MemoryFile(const char* name);
  ~MemoryFile();
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  int descriptor() const { return descriptor_; }
  /// Makes contents() what is in the file now. Once, when nobody writes any more.
  void map();
  std::string_view contents() const { return {static_cast<const char*>(data_), size_}; }

 private:
  int descriptor_;
  void* data_ = nullptr;
  std::size_t size_ = 0;
};

/// Runs a program without a shell, its outputs into memory, its input empty, and waits for its end.
///
/// It is killed when the time is over, and must itself ask for being killed with its parent (PR_SET_PDEATHSIG) or have
/// a group of its own.
class ChildProcess {
 public:
  /// Where a program and the processes that it starts belong.
  enum class Group {
    of_parent,
    /// All of it is killed when the time is over, by an interruption (interruption.h), and when the program has ended:
    /// nothing that it started outlives it.
    own
  };

  /// @param words         path of the program, arguments
  /// @param most_seconds  of the clock on the wall
  /// @param listen        called with each whole line on standard error, some time after it was written, by this
  ///                      thread; if it throws, the program is killed
  /// @param variables     of its environment, "NAME=value", in place of those of this process
  /// @throws InputError if the program cannot be started, std::runtime_error if the system gives no memory for its
  /// output, what listen() throws
  ChildProcess(const std::vector<std::string>& words, double most_seconds,
               const std::function<void(std::string_view line)>& listen = {}, Group group = Group::of_parent,
               const std::vector<std::string>& variables = {});

  bool timed_out() const { return timed_out_; }
  int signal() const;                                                 ///< that ended it, or 0
  int exit_code() const;                                              ///< if it was not ended by a signal
  std::string_view output() const { return output_.contents(); }      ///< standard output
  std::string_view messages() const { return messages_.contents(); }  ///< standard error

 private:
  MemoryFile output_{"abbe-output"};
  MemoryFile messages_{"abbe-messages"};
  int status_ = 0;
  bool timed_out_ = false;
};

}  // namespace abbe
