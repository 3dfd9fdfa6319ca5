#include "abbe/formats/readings/column_reader.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <thread>

#include "abbe/formats/readings/column_rows_program.h"
#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

constexpr const char* kIntact = "an undamaged Parquet or Arrow IPC file that does not change until the end of the run";

std::string python_with_pyarrow() {
  const char* const named = std::getenv(kColumnsPython);
  return named != nullptr && *named != '\0' ? named : "python3";
}

std::string how_to_get_it() {
  return fmt::format(
      "a Python with pyarrow (`python3 -m pip install pyarrow`), named by {} unless it is the python3 of the PATH; or "
      "the readings as CSV",
      kColumnsPython);
}

bool send_all(int socket, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t sent = ::send(socket, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(sent));
  }
  return true;
}

/// Appends bytes until there are `size` of them; false at the end of the stream.
bool receive_until(int socket, std::size_t size, std::string& bytes) {
  constexpr std::size_t kTogether = std::size_t{1} << 20;
  while (bytes.size() < size) {
    const std::size_t before = bytes.size();
    bytes.resize(std::min(size, before + kTogether));
    const ssize_t got = ::recv(socket, bytes.data() + before, bytes.size() - before, 0);
    bytes.resize(before + (got > 0 ? static_cast<std::size_t>(got) : 0));
    if (got == 0 || (got < 0 && errno != EINTR)) return false;
  }
  return true;
}

/// "ok 1234": a word and the number of bytes that follow.
bool receive_head(int socket, std::string& word, std::size_t& size) {
  constexpr std::size_t kLongestHead = 40;
  std::string line;
  while (line.size() < kLongestHead && receive_until(socket, line.size() + 1, line)) {
    if (line.back() != '\n') continue;
    const std::size_t blank = line.find(' ');
    if (blank == std::string::npos) return false;
    word = line.substr(0, blank);
    const char* const end = line.data() + line.size() - 1;
    const auto [behind, problem] = std::from_chars(line.data() + blank + 1, end, size);
    return problem == std::errc() && behind == end;
  }
  return false;
}

void kill_and_wait(pid_t process) {
  ::kill(process, SIGKILL);
  while (::waitpid(process, nullptr, 0) < 0 && errno == EINTR) {
  }
}

/// How a process ended that is ending; of one that goes on after an answer that is none, 0.
int status_at_end(pid_t process) {
  for (int i = 0; i < 100; ++i) {
    int status = 0;
    if (::waitpid(process, &status, WNOHANG) == process) return status;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  kill_and_wait(process);
  return 0;
}

}  // namespace

ColumnReader::~ColumnReader() {
  if (socket_ >= 0) ::close(socket_);
  if (process_ > 0) kill_and_wait(process_);  // it has nothing to finish
}

void ColumnReader::start(std::size_t file) {
  const std::string python = python_with_pyarrow();
  std::vector<std::string> words = {python, "-c", kColumnRowsProgram};
  for (const std::filesystem::path& path : files_) words.push_back(path.string());
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) {
    throw InputError({.file = files_[file].string()},
                     fmt::format("no connection to Python can be made: {}", std::strerror(errno)));
  }
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, messages_.descriptor(), STDERR_FILENO);
  const int problem = ::posix_spawnp(&process_, arguments[0], &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  ::close(ends[1]);
  socket_ = ends[0];
  if (problem == 0) return;
  process_ = 0;
  throw InputError({.file = files_[file].string()},
                   fmt::format("Parquet and Arrow files cannot be read here: {} cannot be started ({})", python,
                               std::strerror(problem)),
                   how_to_get_it());
}

void ColumnReader::refuse_end(std::size_t file) {
  const int status = process_ > 0 ? status_at_end(process_) : 0;
  process_ = -1;
  messages_.map();
  std::string_view said = messages_.contents();
  while (said.ends_with('\n')) said.remove_suffix(1);
  said = said.substr(said.rfind('\n') + 1).substr(0, 300);
  const bool was_killed = WIFSIGNALED(status);
  throw InputError({.file = files_[file].string()},
                   fmt::format("{} ended while it read the file{}{}", python_with_pyarrow(),
                               was_killed ? fmt::format(" ({})", ::strsignal(WTERMSIG(status))) : "",
                               said.empty() ? "" : fmt::format(": {}", said)),
                   was_killed ? kIntact : how_to_get_it());
}

std::string ColumnReader::ask(std::size_t file, const std::string& question) {
  const std::lock_guard lock(mutex_);
  if (process_ == 0) start(file);
  std::string word, answer;
  std::size_t size = 0;
  if (process_ < 0 || !send_all(socket_, question) || !receive_head(socket_, word, size) ||
      !receive_until(socket_, size, answer) || (word != "ok" && word != "refused" && word != "missing")) {
    refuse_end(file);
  }
  if (word == "ok") return answer;
  const InputError::Place place{.file = files_[file].string()};
  if (word == "refused") throw InputError(place, fmt::format("cannot be read: {}", answer), kIntact);
  throw InputError(place, fmt::format("Parquet and Arrow files cannot be read here: {}", answer), how_to_get_it());
}

std::string ColumnReader::columns(std::size_t file) { return ask(file, fmt::format("open {}\n", file)); }

std::string ColumnReader::rows(std::size_t file, std::size_t first, std::size_t last,
                               const std::vector<std::size_t>& columns) {
  return ask(file, fmt::format("rows {} {} {} {}\n", file, first, last, fmt::join(columns, ",")));
}

}  // namespace abbe
