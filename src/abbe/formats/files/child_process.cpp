#include "abbe/formats/files/child_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <thread>

#include "abbe/formats/files/interruption.h"
#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

pid_t start(const std::vector<std::string>& words, int output, int messages, bool own_group) {
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, output, STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, messages, STDERR_FILENO);
  // What this process waits for must end the other one.
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none;
  sigemptyset(&none);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setpgroup(&attributes, 0);
  posix_spawnattr_setflags(&attributes,
                           static_cast<short>(POSIX_SPAWN_SETSIGMASK | (own_group ? POSIX_SPAWN_SETPGROUP : 0)));
  pid_t child = 0;
  const int problem = ::posix_spawn(&child, arguments[0], &actions, &attributes, arguments.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (problem != 0) {
    throw InputError({words[0], 0, 0, ""}, fmt::format("cannot be started: {}", std::strerror(problem)), "a program");
  }
  return child;
}

void end(pid_t child) {
  ::kill(child, SIGKILL);
  while (::waitpid(child, nullptr, 0) < 0 && errno == EINTR) {
  }
}

/// Lines of a file that another process writes.
class GrowingLines {
 public:
  explicit GrowingLines(int descriptor) : descriptor_(descriptor) {}

  void pass_on(const std::function<void(std::string_view line)>& listen) {
    char bytes[4096];
    for (ssize_t count = 0; (count = ::pread(descriptor_, bytes, sizeof bytes, read_)) > 0;) {
      read_ += count;
      rest_.append(bytes, static_cast<std::size_t>(count));
    }
    std::size_t begin = 0;
    for (std::size_t end = 0; (end = rest_.find('\n', begin)) != std::string::npos; begin = end + 1) {
      listen(std::string_view(rest_).substr(begin, end - begin));
    }
    rest_.erase(0, begin);
  }

 private:
  int descriptor_;
  off_t read_ = 0;
  std::string rest_;
};

}  // namespace

MemoryFile::MemoryFile(const char* name) : descriptor_(::memfd_create(name, MFD_CLOEXEC)) {
  if (descriptor_ < 0) throw std::runtime_error("no file in memory can be made");
}

MemoryFile::~MemoryFile() {
  if (size_ > 0) ::munmap(data_, size_);
  ::close(descriptor_);
}

void MemoryFile::map() {
  const off_t size = ::lseek(descriptor_, 0, SEEK_END);
  if (size <= 0) return;
  void* const data = ::mmap(nullptr, static_cast<std::size_t>(size), PROT_READ, MAP_PRIVATE, descriptor_, 0);
  if (data == MAP_FAILED) throw std::runtime_error("the output of a program cannot be mapped");
  data_ = data;
  size_ = static_cast<std::size_t>(size);
}

ChildProcess::ChildProcess(const std::vector<std::string>& words, double most_seconds,
                           const std::function<void(std::string_view line)>& listen, Group group) {
  using Clock = std::chrono::steady_clock;
  const bool own_group = group == Group::own;
  std::optional<UnfinishedProcesses> noted;
  pid_t child = 0;
  {
    std::optional<UninterruptedSteps> together;
    if (own_group) together.emplace();
    child = start(words, output_.descriptor(), messages_.descriptor(), own_group);
    if (own_group) noted.emplace(child);
  }
  const Clock::time_point begin = Clock::now();
  GrowingLines lines(messages_.descriptor());
  Clock::time_point next = begin;
  // Looking every 2 ms costs nothing against what the program does, and needs no signal handler of the whole process.
  while (true) {
    const pid_t ended = ::waitpid(child, &status_, timed_out_ ? 0 : WNOHANG);
    if (ended == child) break;
    if (ended < 0 && errno != EINTR) throw std::runtime_error(fmt::format("{} is lost", words[0]));
    if (!timed_out_ && std::chrono::duration<double>(Clock::now() - begin).count() > most_seconds) {
      timed_out_ = true;
      ::kill(own_group ? -child : child, SIGKILL);
      continue;
    }
    if (listen && Clock::now() > next) {
      try {
        lines.pass_on(listen);
      } catch (...) {
        if (own_group) ::kill(-child, SIGKILL);
        end(child);
        throw;
      }
      next = Clock::now() + std::chrono::milliseconds(100);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  if (listen) lines.pass_on(listen);
  output_.map();
  messages_.map();
}

int ChildProcess::signal() const { return WIFSIGNALED(status_) ? WTERMSIG(status_) : 0; }

int ChildProcess::exit_code() const { return WIFEXITED(status_) ? WEXITSTATUS(status_) : -1; }

}  // namespace abbe
