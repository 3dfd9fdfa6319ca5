#include "cli/run_command.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <system_error>
#include <thread>

namespace abbe {
namespace {

[[noreturn]] void fail(const char* what) { throw std::system_error(errno, std::generic_category(), what); }

/// A pipe that is closed on exec, so that a child only keeps the end it is given.
struct Pipe {
  std::array<int, 2> ends{-1, -1};
  Pipe() {
    if (pipe2(ends.data(), O_CLOEXEC) != 0) fail("pipe");
  }
  ~Pipe() {
    close_end(0);
    close_end(1);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  int reading() const { return ends[0]; }
  int writing() const { return ends[1]; }
  void close_end(std::size_t end) {
    if (ends[end] >= 0) close(ends[end]);
    ends[end] = -1;
  }
};

/// Reads both pipes as data arrive: one after the other would block a program that fills the second first.
void read_both(const Pipe& out, const Pipe& err, CommandResult& result) {
  std::array<pollfd, 2> waiting{{{out.reading(), POLLIN, 0}, {err.reading(), POLLIN, 0}}};
  const std::array<std::string*, 2> texts{&result.out, &result.err};
  std::array<char, 65536> buffer{};
  while (waiting[0].fd >= 0 || waiting[1].fd >= 0) {
    if (poll(waiting.data(), waiting.size(), -1) < 0) {
      if (errno == EINTR) continue;
      fail("poll");
    }
    for (std::size_t i = 0; i < waiting.size(); ++i) {
      if (waiting[i].fd < 0 || waiting[i].revents == 0) continue;
      const ssize_t count = ::read(waiting[i].fd, buffer.data(), buffer.size());
      if (count > 0) {
        texts[i]->append(buffer.data(), static_cast<std::size_t>(count));
      } else if (count == 0 || errno != EINTR) {
        waiting[i].fd = -1;
      }
    }
  }
}

std::vector<char*> pointers(std::vector<std::string>& texts) {
  std::vector<char*> result;
  for (std::string& text : texts) result.push_back(text.data());
  result.push_back(nullptr);
  return result;
}

std::vector<std::string> merged_environment(const std::vector<std::string>& added) {
  std::vector<std::string> result = added;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string_view text = *entry;
    const std::string_view name = text.substr(0, text.find('=') + 1);
    bool replaced = false;
    for (const std::string& other : added) replaced = replaced || std::string_view(other).starts_with(name);
    if (!replaced) result.emplace_back(text);
  }
  return result;
}

/// @param meanwhile  called with the running program, on a thread of its own; told when to end
CommandResult run(const std::string& program, const std::vector<std::string>& arguments,
                  const std::filesystem::path& working_directory, const std::vector<std::string>& environment,
                  const std::function<void(pid_t, const std::atomic<bool>&)>& meanwhile) {
  std::vector<std::string> words{program};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<std::string> settings = merged_environment(environment);
  const std::vector<char*> argv = pointers(words);
  const std::vector<char*> envp = pointers(settings);
  Pipe out;
  Pipe err;
  Pipe started;
  const pid_t child = fork();
  if (child < 0) fail("fork");
  if (child == 0) {
    // Tests that run in the background of a shell would hand on an ignored SIGINT.
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) ::signal(signal, SIG_DFL);
    const int nothing = open("/dev/null", O_RDONLY);
    if (chdir(working_directory.c_str()) == 0 && nothing >= 0 && dup2(nothing, STDIN_FILENO) >= 0 &&
        dup2(out.writing(), STDOUT_FILENO) >= 0 && dup2(err.writing(), STDERR_FILENO) >= 0) {
      execve(program.c_str(), argv.data(), envp.data());
    }
    const int why = errno;
    [[maybe_unused]] const ssize_t written = write(started.writing(), &why, sizeof why);
    _exit(127);
  }
  out.close_end(1);
  err.close_end(1);
  started.close_end(1);
  CommandResult result;
  std::atomic<bool> over = false;
  std::thread other([&] {
    if (meanwhile) meanwhile(child, over);
  });
  read_both(out, err, result);
  // Not a signal to a process that took the number of the one that has ended: it is waited for afterwards.
  over = true;
  other.join();
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  int why = 0;
  if (read(started.reading(), &why, sizeof why) == static_cast<ssize_t>(sizeof why)) {
    throw std::system_error(why, std::generic_category(), "starting " + program);
  }
  result.exit_code = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  return result;
}

}  // namespace

CommandResult run_program(const std::string& program, const std::vector<std::string>& arguments,
                          const std::filesystem::path& working_directory, const std::vector<std::string>& environment) {
  return run(program, arguments, working_directory, environment, {});
}

CommandResult run_and_signal(const std::string& program, const std::vector<std::string>& arguments,
                             const std::filesystem::path& working_directory, int signal,
                             const std::function<bool(pid_t)>& is_time) {
  bool signalled = false;
  CommandResult result =
      run(program, arguments, working_directory, {}, [&](pid_t child, const std::atomic<bool>& over) {
        while (!over) {
          if (is_time(child)) {
            signalled = !over && ::kill(child, signal) == 0;
            return;
          }
          std::this_thread::sleep_for(std::chrono::microseconds(200));
        }
      });
  result.signalled = signalled;
  return result;
}

TemporaryFolder::TemporaryFolder() {
  std::string pattern = (std::filesystem::temp_directory_path() / "abbe-test-XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr) fail("mkdtemp");
  path_ = pattern;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::filesystem::path TemporaryFolder::write(const std::string& name, std::string_view text) const {
  std::filesystem::path file = path_ / name;
  std::filesystem::create_directories(file.parent_path());
  std::ofstream stream(file, std::ios::binary);
  stream.write(text.data(), static_cast<std::streamsize>(text.size()));
  stream.close();
  EXPECT_TRUE(stream.good()) << "cannot write " << file;
  return file;
}

std::string TemporaryFolder::read(const std::string& name) const {
  std::ifstream stream(path_ / name, std::ios::binary);
  EXPECT_TRUE(stream.is_open()) << "no file " << path_ / name;
  return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace abbe
