// abbe-mpi: the command `abbe` in several processes, which mpirun starts. Subcommands that share their work run in all
// of them, others in the first one alone. The first one writes and prints.
#include <malloc.h>
#include <unistd.h>

#include <cstdio>
#include <string>
#include <string_view>

#include "command_main.h"
#include "mpi_group.h"
#include "subcommands.h"

namespace {

/// Standard output and error of a process that is not to say anything by itself.
class KeptMessages {
 public:
  KeptMessages() : file_(std::tmpfile()) {
    if (file_ == nullptr) return;
    for (const int stream : {STDOUT_FILENO, STDERR_FILENO}) ::dup2(::fileno(file_), stream);
  }
  /// What was said, on one line.
  std::string text() {
    std::string all;
    if (file_ == nullptr) return all;
    std::fflush(nullptr);
    std::rewind(file_);
    for (int letter = std::fgetc(file_); letter != EOF; letter = std::fgetc(file_)) {
      all += letter == '\n' ? ' ' : static_cast<char>(letter);
    }
    while (!all.empty() && all.back() == ' ') all.pop_back();
    constexpr std::string_view kBefore = "abbe: ";
    return all.starts_with(kBefore) ? all.substr(kBefore.size()) : all;
  }

 private:
  std::FILE* file_;
};

}  // namespace

int main(int argc, char** argv) {
  // Messages and blocks come and go. Freed memory is kept, so that the kernel need not clear new pages for each.
  ::mallopt(M_MMAP_THRESHOLD, 32 << 20);
  ::mallopt(M_TRIM_THRESHOLD, 256 << 20);
  abbe::MpiGroup group(&argc, &argv);
  const auto add = [&group](abbe::CommandLine& line) {
    line.processes = &group;
    abbe::add_subcommands(line);
  };
  if (group.is_first()) return abbe::command_main(argc, argv, add);
  KeptMessages messages;
  abbe::command_main(argc, argv, add);
  group.leave(messages.text());
  return 0;
}
