#include "abbe/formats/streamed_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>

#include "abbe/formats/kept_inputs.h"
#include "abbe/formats/partial_names.h"
#include "abbe/formats/write_error.h"

namespace abbe {
namespace {

namespace fs = std::filesystem;

}  // namespace

StreamedFile::StreamedFile(const fs::path& path) : path_(file_to_write(path)), partial_(partial_name(path_)) {
  refuse_input_as_output(path_);
  remove_partials_of_killed_writers(path_);
  unfinished_.emplace(partial_);
  const UninterruptedSteps steps;
  const fs::path folder = path_.parent_path().empty() ? fs::path(".") : path_.parent_path();
#ifdef O_TMPFILE
  file_ = ::open(folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666);
#endif
  if (file_ < 0) {
    file_ = ::open(partial_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    is_named_ = file_ >= 0;
  }
  if (file_ < 0) fail_to_write(path_, errno);
}

StreamedFile::~StreamedFile() {
  if (file_ >= 0) ::close(file_);
  if (is_named_) ::unlink(partial_.c_str());
}

void StreamedFile::append(std::string_view contents) {
  while (!contents.empty()) {
    const ssize_t written = ::write(file_, contents.data(), contents.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail_to_write(path_, errno);
    contents.remove_prefix(static_cast<std::size_t>(written));
  }
}

void StreamedFile::overwrite(std::size_t offset, std::string_view contents) {
  while (!contents.empty()) {
    const ssize_t written = ::pwrite(file_, contents.data(), contents.size(), static_cast<off_t>(offset));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail_to_write(path_, errno);
    contents.remove_prefix(static_cast<std::size_t>(written));
    offset += static_cast<std::size_t>(written);
  }
}

void StreamedFile::commit() {
  if (::fsync(file_) != 0) fail_to_write(path_, errno);
  const UninterruptedSteps steps;
  if (!is_named_) {
    // A file without a name cannot take the place of another one: it gets a name first.
    ::unlink(partial_.c_str());
    const std::string open_file = fmt::format("/proc/self/fd/{}", file_);
    if (::linkat(AT_FDCWD, open_file.c_str(), AT_FDCWD, partial_.c_str(), AT_SYMLINK_FOLLOW) != 0)
      fail_to_write(path_, errno);
    is_named_ = true;
  }
  const int closed = ::close(file_);
  file_ = -1;
  if (closed != 0 || ::rename(partial_.c_str(), path_.c_str()) != 0) fail_to_write(path_, errno);
  is_named_ = false;
}

}  // namespace abbe
