#include "abbe/formats/files/child_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
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

/// The environment of this process with other values; views of both.
std::vector<char*> environment_with(const std::vector<std::string>& variables) {
  std::vector<char*> environment;
  for (char** variable = environ; *variable != nullptr; ++variable) {
    const std::string_view text = *variable;
    const std::string_view name = text.substr(0, text.find('='));
    const bool is_other = std::none_of(variables.begin(), variables.end(), [&](const std::string& other) {
      return std::string_view(other).substr(0, other.find('=')) == name;
    });
    if (is_other) environment.push_back(*variable);
  }
  for (const std::string& variable : variables) environment.push_back(const_cast<char*>(variable.c_str()));
  environment.push_back(nullptr);
  return environment;
}

pid_t start(const std::vector<std::string>& words, int output, int messages, bool own_group,
            const std::vector<std::string>& variables) {
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  const std::vector<char*> environment = environment_with(variables);
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
  const int problem = ::posix_spawn(&child, arguments[0], &actions, &attributes, arguments.data(), environment.data());
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (problem != 0) {
    throw InputError({words[0], 0, 0, ""}, fmt::format("cannot be started: {}", std::strerror(problem)), "a program");
  }
  return child;
}

/// Whether it has ended; its end stays to be received. Also true if it cannot be asked, so that waiting says why.
bool has_ended(pid_t child) {
  siginfo_t ended = {};
  if (::waitid(P_PID, static_cast<id_t>(child), &ended, WEXITED | WNOHANG | WNOWAIT) != 0) return errno != EINTR;
  return ended.si_pid == child;
}

/// Killed processes that nobody has received yet count as running, so the wait has an end.
void wait_for_group(pid_t group) {
  for (int i = 0; i < 100 && ::kill(-group, 0) == 0; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(2));
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
                           const std::function<void(std::string_view line)>& listen, Group group,
                           const std::vector<std::string>& variables) {
  using Clock = std::chrono::steady_clock;
  const bool own_group = group == Group::own;
  std::optional<UnfinishedProcesses> noted;
  pid_t child = 0;
  {
    std::optional<UninterruptedSteps> together;
    if (own_group) together.emplace();
    child = start(words, output_.descriptor(), messages_.descriptor(), own_group, variables);
    if (own_group) noted.emplace(child);
  }
  const Clock::time_point begin = Clock::now();
  GrowingLines lines(messages_.descriptor());
  Clock::time_point next = begin;
  // Looking every 2 ms costs nothing against what the program does, and needs no signal handler of the whole process.
  while (true) {
    if (!own_group || timed_out_ || has_ended(child)) {
      // What it has left running would still write where its owner cleans up. The number of the group is nobody else's
      // before the end of the program has been received.
      if (own_group) ::kill(-child, SIGKILL);
      const pid_t ended = ::waitpid(child, &status_, timed_out_ ? 0 : WNOHANG);
      if (ended == child) break;
      if (ended < 0 && errno != EINTR) throw std::runtime_error(fmt::format("{} is lost", words[0]));
    }
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
  if (own_group) wait_for_group(child);
  if (listen) lines.pass_on(listen);
  output_.map();
  messages_.map();
}

int ChildProcess::signal() const { return WIFSIGNALED(status_) ? WTERMSIG(status_) : 0; }

int ChildProcess::exit_code() const { return WIFEXITED(status_) ? WEXITSTATUS(status_) : -1; }

}  // namespace abbe
