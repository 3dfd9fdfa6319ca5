#include "abbe/formats/results_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstdio>
#include <string>
#include <system_error>

#include "abbe/formats/input_error.h"
#include "abbe/formats/kept_inputs.h"
#include "abbe/formats/partial_names.h"
#include "abbe/formats/write_error.h"

namespace abbe {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPartial = ".partial-";
constexpr std::string_view kOld = ".old-";
constexpr const char* kMarker = ".abbe-results";

/// File descriptor that is closed on every path.
class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int number() const { return number_; }
  int close() {
    const int result = ::close(number_);
    number_ = -1;
    return result;
  }

 private:
  int number_;
};

void flush_folder(const fs::path& path) {
  Descriptor folder(::open(path.empty() ? "." : path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  // Some file systems cannot flush a folder and say EINVAL.
  if (folder.number() < 0 || (::fsync(folder.number()) != 0 && errno != EINVAL)) fail_to_write(path, errno);
}

int made(const fs::path& path) {
  const UninterruptedSteps steps;
  return ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
}

/// @param called  what messages call it: its name when all is done
void write_and_flush(const fs::path& path, std::string_view contents, const fs::path& called) {
  Descriptor file(made(path));
  if (file.number() < 0) fail_to_write(called, errno);
  while (!contents.empty()) {
    const ssize_t written = ::write(file.number(), contents.data(), contents.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail_to_write(called, errno);
    contents.remove_prefix(static_cast<std::size_t>(written));
  }
  if (::fsync(file.number()) != 0 || file.close() != 0) fail_to_write(called, errno);
}

fs::path with_suffix(const fs::path& path, std::string_view suffix) {
  return path.parent_path() / fmt::format("{}{}{}", path.filename().string(), suffix, ::getpid());
}

/// Process number at the end of a name left by a writer of `name`, or 0.
pid_t writer_of(const std::string& found, const std::string& name, std::string_view suffix) {
  const std::string start = name + std::string(suffix);
  pid_t process = 0;
  if (!found.starts_with(start)) return 0;
  const char* const end = found.data() + found.size();
  const auto result = std::from_chars(found.data() + start.size(), end, process);
  return result.ec == std::errc() && result.ptr == end ? process : 0;
}

/// Exchanges two names in one step where the file system can. @returns errno, 0 if done
int exchange(const fs::path& a, const fs::path& b) {
  return ::renameat2(AT_FDCWD, a.c_str(), AT_FDCWD, b.c_str(), RENAME_EXCHANGE) == 0 ? 0 : errno;
}

}  // namespace

fs::path file_to_write(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) return path;
  if (fs::is_directory(status)) fail_to_write(path, EISDIR);
  if (!fs::is_regular_file(status)) {
    throw InputError({path.string(), 0, 0, ""}, "is a device, a pipe or a socket", "the name of a file to write");
  }
  if (!fs::is_symlink(fs::symlink_status(path, error))) return path;
  fs::path target = fs::canonical(path, error);
  if (error) fail_to_write(path, error.value());
  return target;
}

fs::path partial_name(const fs::path& path) { return with_suffix(path, kPartial); }

void remove_partials_of_killed_writers(const fs::path& path) {
  std::error_code error;
  const fs::path folder = path.parent_path().empty() ? fs::path(".") : path.parent_path();
  const std::string name = path.filename().string();
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const std::string found = entry->path().filename().string();
    const pid_t old_writer = writer_of(found, name, kOld), partial_writer = writer_of(found, name, kPartial);
    const pid_t process = old_writer > 0 ? old_writer : partial_writer;
    if (process <= 0 || process == ::getpid() || ::kill(process, 0) == 0 || errno != ESRCH) continue;
    std::error_code ignored;
    if (old_writer > 0 && !fs::exists(path, ignored)) {
      fs::rename(entry->path(), path, ignored);
    } else {
      fs::remove_all(entry->path(), ignored);
    }
  }
}

void check_results_folder(const fs::path& name) {
  std::error_code error;
  const auto status = fs::status(name, error);
  if (!fs::exists(status)) return;
  if (!fs::is_directory(status)) throw InputError({name.string(), 0, 0, ""}, "is a file", "a folder for results");
  refuse_input_as_output(name);
  for (const char* const own : {kMarker, "summary.json", "evaluation.json"}) {
    if (fs::exists(name / own, error)) return;
  }
  // Results replace a folder as a whole: what somebody else keeps there must not go with it.
  if (fs::directory_iterator(name, error) != fs::directory_iterator() || error) {
    throw InputError({name.string(), 0, 0, ""}, "holds files that are no results of abbe",
                     "a new or empty folder, or one with results, which are replaced");
  }
}

ResultsFolder::ResultsFolder(fs::path name) : name_(std::move(name)) {
  if (name_.filename().empty()) name_ = name_.parent_path();
  partial_ = partial_name(name_);
  check_results_folder(name_);
  std::error_code error;
  if (!name_.parent_path().empty()) fs::create_directories(name_.parent_path(), error);
  if (error) fail_to_write(name_, error.value());
  remove_partials_of_killed_writers(name_);
  unfinished_.emplace(partial_);
  const UninterruptedSteps steps;
  fs::remove_all(partial_, error);
  fs::create_directory(partial_, error);
  if (error) fail_to_write(name_, error.value());
}

ResultsFolder::~ResultsFolder() {
  std::error_code ignored;
  if (!committed_) fs::remove_all(partial_, ignored);
}

void ResultsFolder::write(const fs::path& relative, std::string_view contents) {
  const fs::path path = partial_ / relative;
  std::error_code error;
  {
    const UninterruptedSteps steps;
    fs::create_directories(path.parent_path(), error);
  }
  const fs::path called = name_ / relative;
  if (error) fail_to_write(called.parent_path(), error.value());
  write_and_flush(path, contents, called);
}

void ResultsFolder::commit() {
  write(kMarker, "Results of abbe: the next ones written here replace this folder as a whole.\n");
  std::error_code error;
  for (fs::recursive_directory_iterator entry(partial_, error), end; !error && entry != end; entry.increment(error)) {
    if (entry->is_directory()) flush_folder(entry->path());
  }
  if (error) fail_to_write(name_, error.value());
  flush_folder(partial_);

  const UninterruptedSteps steps;
  fs::path aside;
  if (!fs::exists(name_, error)) {
    if (::rename(partial_.c_str(), name_.c_str()) != 0) fail_to_write(name_, errno);
  } else if (exchange(partial_, name_) == 0) {
    aside = partial_;
  } else {
    aside = with_suffix(name_, kOld);
    if (::rename(name_.c_str(), aside.c_str()) != 0) fail_to_write(name_, errno);
    if (::rename(partial_.c_str(), name_.c_str()) != 0) {
      const int problem = errno;
      fs::rename(aside, name_, error);
      fail_to_write(name_, problem);
    }
  }
  committed_ = true;
  flush_folder(name_.parent_path());
  if (!aside.empty()) fs::remove_all(aside, error);
}

void write_file_atomically(const fs::path& name, std::string_view contents) {
  refuse_input_as_output(name);
  const fs::path path = file_to_write(name);
  const fs::path partial = partial_name(path);
  remove_partials_of_killed_writers(path);
  const UnfinishedPath unfinished(partial);
  try {
    write_and_flush(partial, contents, name);
    const UninterruptedSteps steps;
    if (::rename(partial.c_str(), path.c_str()) != 0) fail_to_write(name, errno);
  } catch (...) {
    ::unlink(partial.c_str());
    throw;
  }
  flush_folder(path.parent_path());
}

}  // namespace abbe
