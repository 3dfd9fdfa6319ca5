#include "abbe/formats/files/unfinished_output.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <string>
#include <system_error>
#include <utility>

#include "abbe/formats/files/remove_unfinished.h"
#include "abbe/formats/files/write_error.h"
#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kDigits = 16;
constexpr int kAttempts = 100;

/// Without following a link, and without waiting for the other end of a pipe.
Descriptor opened(const fs::path& path) {
  return Descriptor(::open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
}

bool is_hexadecimal(std::string_view text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); });
}

/// Whether name_beside() made this name.
bool is_beside(std::string_view found, const std::string& name, std::string_view ending) {
  const std::string start = "." + name + ".";
  return found.size() == start.size() + kDigits + ending.size() && found.substr(0, start.size()) == start &&
         found.substr(start.size() + kDigits) == ending && is_hexadecimal(found.substr(start.size(), kDigits));
}

}  // namespace

fs::path resolved_output(const fs::path& name) {
  std::error_code error;
  fs::path path = fs::weakly_canonical(fs::absolute(name, error), error);
  if (error) fail_to_write(name, error.value());
  if (path.filename().empty()) path = path.parent_path();
  return path;
}

fs::path file_to_write(const fs::path& name) {
  std::error_code error;
  const fs::file_status status = fs::status(name, error);
  if (fs::is_directory(status)) fail_to_write(name, EISDIR);
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    throw InputError({name.string(), 0, 0, ""}, "is a device, a pipe or a socket", "the name of a file to write");
  }
  return resolved_output(name);
}

fs::path existing_folder_above(const fs::path& path) {
  fs::path folder = path.parent_path();
  std::error_code ignored;
  while (folder.has_relative_path() && !fs::exists(fs::symlink_status(folder, ignored))) folder = folder.parent_path();
  return folder;
}

void check_folder_to_write_in(const fs::path& folder, const fs::path& called) {
  struct stat status {};
  if (::stat(folder.c_str(), &status) != 0) fail_to_write(called, errno);
  if (!S_ISDIR(status.st_mode)) fail_to_write(called, ENOTDIR);
  if (::faccessat(AT_FDCWD, folder.c_str(), W_OK | X_OK, AT_EACCESS) != 0) fail_to_write(called, errno);
}

Descriptor& Descriptor::operator=(Descriptor&& other) noexcept {
  if (this != &other) {
    close();
    number_ = std::exchange(other.number_, -1);
  }
  return *this;
}

int Descriptor::close() {
  const int number = std::exchange(number_, -1);
  return number < 0 || ::close(number) == 0 ? 0 : errno;
}

Descriptor nameless_file(const fs::path& folder) {
#ifdef O_TMPFILE
  return Descriptor(::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0666));
#else
  return Descriptor();
#endif
}

int give_name(const Descriptor& nameless, const fs::path& path) {
  const std::string open_file = fmt::format("/proc/self/fd/{}", nameless.number());
  return ::linkat(AT_FDCWD, open_file.c_str(), AT_FDCWD, path.c_str(), AT_SYMLINK_FOLLOW) == 0 ? 0 : errno;
}

fs::path name_beside(const fs::path& output, std::string_view ending) {
  std::uint64_t random = 0;
  while (::getrandom(&random, sizeof random, 0) != sizeof random) {
  }
  return output.parent_path() / fmt::format(".{}.{:016x}{}", output.filename().string(), random, ending);
}

bool is_named(const Descriptor& file, const fs::path& path) {
  struct stat open_file {
  }, named{};
  return ::fstat(file.number(), &open_file) == 0 && ::lstat(path.c_str(), &named) == 0 &&
         open_file.st_dev == named.st_dev && open_file.st_ino == named.st_ino;
}

fs::path unfinished_name(const fs::path& output) {
  fs::path name = output;
  if (name.filename().empty()) name = name.parent_path();
  name += ".unfinished";
  return name;
}

bool lock_if_free(const Descriptor& file) { return ::flock(file.number(), LOCK_EX | LOCK_NB) == 0; }

UnfinishedOutput::UnfinishedOutput(const fs::path& output, Kind kind, const fs::path& called) : output_(output) {
  const UninterruptedSteps steps;
  int error = EEXIST;
  // Another process may have the name, or take what was just made for abandoned and remove it before it is locked.
  for (int attempt = 0; attempt < kAttempts && error == EEXIST; ++attempt) error = make(kind);
  if (error != 0) fail_to_write(called, error);
}

int UnfinishedOutput::make(Kind kind) {
  path_ = name_beside(output_, kUnfinished);
  if (kind == Kind::folder) {
    if (::mkdir(path_.c_str(), 0777) != 0) return errno;
    held_ = opened(path_);
    // Removed before it could be opened.
    if (!held_.is_open() && errno == ENOENT) return EEXIST;
  } else {
    held_ = Descriptor(::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666));
  }
  if (!held_.is_open()) return errno;
  // Whoever holds it looks whether it is abandoned, for a moment. Some file systems have no locks; there nobody removes
  // it.
  while (::flock(held_.number(), LOCK_EX) != 0 && errno == EINTR) {
  }
  if (!is_named(held_, path_)) return EEXIST;
  noted_.emplace(path_);
  return 0;
}

UnfinishedOutput::~UnfinishedOutput() {
  if (noted_) remove_unfinished(path_);
}

void UnfinishedOutput::release() {
  noted_.reset();
  held_.close();
}

void for_abandoned(const fs::path& output, std::string_view ending, const std::function<void(const fs::path&)>& found) {
  std::error_code error;
  const std::string name = output.filename().string();
  for (fs::directory_iterator entry(output.parent_path(), error), end; !error && entry != end; entry.increment(error)) {
    const fs::path path = entry->path();
    if (!is_beside(path.filename().string(), name, ending)) continue;
    const Descriptor file = opened(path);
    if (!file.is_open() || !lock_if_free(file) || !is_named(file, path)) continue;
    const fs::file_status status = fs::symlink_status(path, error);
    if (fs::is_directory(status) || fs::is_regular_file(status)) found(path);
  }
}

int write_all(int file, std::string_view contents) {
  while (!contents.empty()) {
    const ssize_t written = ::write(file, contents.data(), contents.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    contents.remove_prefix(static_cast<std::size_t>(written));
  }
  return 0;
}

int rename_to_new(const fs::path& from, const fs::path& to) {
  if (::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) return 0;
  if (errno != EINVAL && errno != ENOSYS) return errno;
  struct stat status {};
  if (::lstat(from.c_str(), &status) != 0) return errno;
  // A folder takes the place of an empty one at most.
  if (S_ISDIR(status.st_mode)) return ::rename(from.c_str(), to.c_str()) == 0 ? 0 : errno;
  // A second name for the file is never given to what exists.
  if (::link(from.c_str(), to.c_str()) == 0) return ::unlink(from.c_str()) == 0 ? 0 : errno;
  if (errno == EEXIST || ::lstat(to.c_str(), &status) == 0) return EEXIST;
  return ::rename(from.c_str(), to.c_str()) == 0 ? 0 : errno;
}

int flush_folder(const fs::path& folder) {
  const Descriptor open_folder(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  // Some file systems cannot flush a folder and say EINVAL.
  if (!open_folder.is_open() || (::fsync(open_folder.number()) != 0 && errno != EINVAL)) return errno;
  return 0;
}

}  // namespace abbe
