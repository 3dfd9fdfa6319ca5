#include "abbe/formats/files/checkpoint.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <system_error>

#include "abbe/formats/files/crc32c.h"
#include "abbe/formats/files/remove_unfinished.h"
#include "abbe/formats/files/unfinished_output.h"
#include "abbe/formats/files/write_error.h"
#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kCheckpointLine = "abbe unfinished 1\n";

std::string read_whole(const Descriptor& file, const fs::path& called) {
  std::string contents;
  std::array<char, 1 << 16> block;
  ::lseek(file.number(), 0, SEEK_SET);
  for (ssize_t size = 0; (size = ::read(file.number(), block.data(), block.size())) != 0;) {
    if (size < 0 && errno == EINTR) continue;
    if (size < 0) {
      throw InputError({.file = called.string()}, "cannot be read: " + std::generic_category().message(errno));
    }
    contents.append(block.data(), static_cast<std::size_t>(size));
  }
  return contents;
}

std::string checksum_bytes(std::string_view contents) {
  const std::uint32_t sum = crc32c(contents);
  std::string bytes(sizeof sum, '\0');
  std::memcpy(bytes.data(), &sum, sizeof sum);
  return bytes;
}

}  // namespace

Checkpoint::Checkpoint(const fs::path& output, CheckpointFacts facts)
    : called_(unfinished_name(output)), path_(unfinished_name(resolved_output(output))), facts_(std::move(facts)) {
  std::error_code error;
  fs::create_directories(path_.parent_path(), error);
  if (error) fail_to_write(called_, error.value());
  open_and_lock();
  // What a kill during save() left.
  for_abandoned(path_, kUnfinished, remove_unfinished);
  read_state();
}

Checkpoint::~Checkpoint() {
  // An empty one says nothing; it is there for the lock only.
  if (held_ && !has_state_) ::unlink(path_.c_str());
}

void Checkpoint::open_and_lock() {
  constexpr int kAttempts = 100;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    auto file = std::make_unique<Descriptor>(::open(path_.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666));
    if (!file->is_open()) fail_to_write(called_, errno);
    if (!lock_if_free(*file)) {
      if (errno == EWOULDBLOCK) {
        throw InputError({.file = called_.string()}, "another process works on this output",
                         "its end, or another name for the output");
      }
      // There are no locks on this file system.
    }
    if (!is_named(*file, path_)) continue;
    held_ = std::move(file);
    return;
  }
  fail_to_write(called_, EAGAIN);
}

std::string Checkpoint::header() const {
  std::string text(kCheckpointLine);
  for (const auto& [name, value] : facts_) text += name + ": " + value + '\n';
  return text + '\n';
}

void Checkpoint::read_state() {
  const std::string contents = read_whole(*held_, called_);
  if (contents.empty()) return;
  has_state_ = true;  // whatever it is, it is not ours to remove
  const auto refuse = [&](const std::string& problem) {
    throw InputError({.file = called_.string()}, problem,
                     "the files and options with which it was begun; or remove this file, to begin anew");
  };
  constexpr std::size_t kChecksum = 4;
  const std::size_t body = contents.size() < kChecksum ? 0 : contents.size() - kChecksum;
  const std::size_t header_end = contents.find("\n\n");
  if (!contents.starts_with(kCheckpointLine) || header_end == std::string::npos || header_end + 2 > body ||
      checksum_bytes(std::string_view(contents).substr(0, body)) != contents.substr(body)) {
    refuse("is no checkpoint of this program, or is damaged");
  }
  const std::string own = header();
  const std::string_view other = std::string_view(contents).substr(0, header_end + 2);
  if (other != own) {
    // The first line that differs says why.
    std::size_t at = 0;
    while (at < own.size() && at < other.size() && own[at] == other[at]) ++at;
    const auto line_at = [&](std::string_view text) {
      const std::size_t begin = at == 0 ? 0 : text.rfind('\n', at - 1) + 1;
      return std::string(text.substr(begin, text.find('\n', begin) - begin));
    };
    refuse(fmt::format("is the checkpoint of another job: it has '{}', not '{}'", line_at(other), line_at(own)));
  }
  found_ = contents.substr(header_end + 2, body - header_end - 2);
}

void Checkpoint::save(std::string_view state) {
  std::string contents = header();
  contents += state;
  contents += checksum_bytes(contents);
  UnfinishedOutput next(path_, UnfinishedOutput::Kind::file, called_);
  int error = write_all(next.descriptor(), contents);
  if (error == 0 && ::fsync(next.descriptor()) != 0) error = errno;
  if (error != 0) fail_to_write(called_, error);
  // The lock belongs to the open file, however many numbers it has.
  auto held = std::make_unique<Descriptor>(::fcntl(next.descriptor(), F_DUPFD_CLOEXEC, 0));
  if (!held->is_open()) fail_to_write(called_, errno);
  {
    const UninterruptedSteps steps;
    if (::rename(next.path().c_str(), path_.c_str()) != 0) fail_to_write(called_, errno);
    next.release();
  }
  held_ = std::move(held);
  has_state_ = true;
  flush_folder(path_.parent_path());
}

void Checkpoint::remove() {
  if (held_) ::unlink(path_.c_str());
  held_.reset();
  has_state_ = false;
}

}  // namespace abbe
