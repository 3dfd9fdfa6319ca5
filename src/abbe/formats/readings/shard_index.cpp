#include "abbe/formats/readings/shard_index.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "abbe/formats/text/input_error.h"
#include "abbe/geometry/digest.h"

namespace abbe {
namespace {

constexpr std::size_t kReadTogether = std::size_t{4} << 20;

/// As csv_is_passed_over(): blank lines and comments are no rows.
bool is_row(std::string_view line) {
  const std::size_t at = line.find_first_not_of(" \t\r\n");
  return at != std::string_view::npos && line[at] != '#';
}

/// Takes the lines of a file one after the other.
class RowFinder {
 public:
  RowFinder(std::size_t file, std::size_t first, std::size_t together) : next_(first), together_(together) {
    part_.file = file;
  }

  void take(std::string_view line) {
    ++line_;
    if (is_row(line)) {
      if (rows_.header.empty()) {
        rows_.header = std::string(line);
      } else {
        take_row();
      }
    }
    at_ += line.size();
    part_.end = at_;
    if (part_.count > 0 && next_ % together_ == 0) finish_part();
  }

  ShardRows finish() {
    if (part_.count > 0) finish_part();
    return std::move(rows_);
  }

  std::size_t line() const { return line_; }

 private:
  void take_row() {
    if (part_.count == 0) {
      part_.begin = at_;
      part_.line = line_;
      part_.first = next_;
    }
    ++part_.count;
    ++next_;
    ++rows_.count;
  }

  void finish_part() {
    rows_.parts.push_back(part_);
    part_.count = 0;
  }

  ShardRows rows_;
  ShardPart part_;
  std::size_t next_, together_, line_ = 0, at_ = 0;
};

}  // namespace

PartFile::PartFile(const std::filesystem::path& path) : path_(path) {
  descriptor_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  struct stat status {};
  if (descriptor_ >= 0 && ::fstat(descriptor_, &status) == 0 && S_ISREG(status.st_mode) && status.st_size > 0) {
    size_ = static_cast<std::size_t>(status.st_size);
    return;
  }
  const int error = errno;
  const bool opened = descriptor_ >= 0;
  if (opened) ::close(descriptor_);
  throw InputError({.file = path.string()},
                   opened ? "is empty or no regular file" : fmt::format("cannot be opened: {}", std::strerror(error)),
                   "a file of readings on disk, which is read several times");
}

PartFile::~PartFile() { ::close(descriptor_); }

std::string PartFile::read(std::size_t begin, std::size_t end) const {
  std::string text(end - begin, '\0');
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t got = ::pread(descriptor_, text.data() + done, text.size() - done, static_cast<off_t>(begin + done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw InputError({.file = path_.string()}, fmt::format("cannot be read: {}", std::strerror(errno)));
    if (got == 0) {
      throw InputError({.file = path_.string()}, "has become shorter since it was read first",
                       fmt::format("{} bytes until the end of the run", size_));
    }
    done += static_cast<std::size_t>(got);
  }
  return text;
}

ShardRows find_rows(const PartFile& file, std::size_t number, std::size_t first, std::size_t together,
                    const std::function<void(std::size_t)>& read) {
  RowFinder finder(number, first, together);
  std::string line;  // begun in an earlier block
  Digest content;
  for (std::size_t begin = 0; begin < file.size(); begin += kReadTogether) {
    const std::string block = file.read(begin, std::min(file.size(), begin + kReadTogether));
    content.add_text(block);
    std::string_view rest = block;
    for (std::size_t end; (end = rest.find('\n')) != std::string_view::npos; rest.remove_prefix(end + 1)) {
      const std::string_view part = rest.substr(0, end + 1);
      if (line.empty()) {
        finder.take(part);
        continue;
      }
      line += part;
      finder.take(line);
      line.clear();
    }
    line += rest;
    read(block.size());
  }
  const auto name = file.path().string();
  if (!line.empty()) {
    throw InputError({.file = name, .line = finder.line() + 1},
                     "the file ends within a row: it may have been cut off, and the last number with it",
                     "a line end after the last row");
  }
  ShardRows rows = finder.finish();
  if (rows.header.empty()) throw InputError({.file = name}, "has no header", "a line with the names of the columns");
  if (rows.count == 0) throw InputError({.file = name}, "has no readings", "at least one row below the header");
  rows.content = content.value();
  return rows;
}

}  // namespace abbe
