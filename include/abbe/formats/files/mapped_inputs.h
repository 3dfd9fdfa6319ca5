#pragma once

#include <cstddef>
#include <string>

namespace abbe {

/// From now on the process ends with a message on standard error and this exit code where it reads a file in memory
/// (MappedFile) that somebody has cut short meanwhile. Otherwise the system ends it by SIGBUS, and nobody knows why.
/// For main(). Outputs that were being written are left to the next writer (unfinished_output.h).
void end_where_an_input_was_cut_short(int exit_code);

/// While it lives, the message names this file for reading in [begin, begin + size). At most 64 at a time have a name.
class MappedInput {
 public:
  MappedInput(const char* begin, std::size_t size, const std::string& name);
  ~MappedInput();
  MappedInput(const MappedInput&) = delete;
  MappedInput& operator=(const MappedInput&) = delete;

 private:
  std::size_t place_;
};

}  // namespace abbe
