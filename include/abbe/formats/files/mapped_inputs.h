#pragma once

#include <cstddef>
#include <string>

namespace abbe {

/// From now on, reading a mapped file (MappedFile) that has been truncated meanwhile ends the process with a message on
/// standard error and this exit code. Otherwise the system would end it by SIGBUS without an explanation.
/// For main(). Outputs that were being written are left to the next writer (unfinished_output.h).
void end_where_an_input_was_cut_short(int exit_code);

/// While it exists, the message names this file for addresses in [begin, begin + size). At most 64 at a time.
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
