#include "abbe/formats/files/work_checkpoint.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include "abbe/formats/files/crc32c.h"
#include "abbe/formats/files/unfinished_output.h"
#include "abbe/formats/files/write_error.h"
#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kKindOfFile = "abbe unfinished work 1\n";
/// A record: fingerprint of the work, number of the block, bytes of its results; the results; CRC-32C of all that.
using RecordHead = std::array<std::uint64_t, 3>;
constexpr std::size_t kChecksumBytes = sizeof(std::uint32_t);

/// @returns whether all bytes were there
bool read_at(const Descriptor& file, std::size_t at, char* to, std::size_t size) {
  while (size > 0) {
    const ssize_t got = ::pread(file.number(), to, size, static_cast<off_t>(at));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    at += static_cast<std::size_t>(got);
    to += got;
    size -= static_cast<std::size_t>(got);
  }
  return true;
}

std::size_t size_of(const Descriptor& file) {
  struct stat found {};
  return ::fstat(file.number(), &found) == 0 ? static_cast<std::size_t>(found.st_size) : 0;
}

}  // namespace

/// One list of blocks while it is worked on.
class WorkCheckpoint::OneWork {
 public:
  OneWork(WorkCheckpoint& all, const NumberedWork& work)
      : all_(all), work_(work), rest_(work), begin_s_(all.seconds()) {
    rest_.is_there.resize(work.blocks);
    if (!all.found_.empty()) take_found();
    for (const std::uint8_t there : rest_.is_there) open_ += there == 0 ? 1 : 0;
    rest_.finished = [this](std::size_t block) { finish(block); };
    rest_.reduce = nullptr;
  }

  /// What was not written need not be kept any longer.
  void end() {
    for (const std::size_t block : not_written_) reduce(block);
  }

  const NumberedWork& rest() const { return rest_; }

 private:
  std::uint64_t fingerprint() {
    if (!fingerprint_) fingerprint_ = work_.fingerprint();
    return *fingerprint_;
  }

  void take_found() {
    const auto found = all_.found_.find(fingerprint());
    if (found == all_.found_.end()) return;
    std::size_t count = 0;
    for (const auto& [block, place] : found->second) {
      if (block >= work_.blocks)
        throw WorkError("the unfinished work contains a block that does not belong to this work");
      work_.unpack(block, all_.read(place));
      rest_.is_there[block] = 1;
      if (work_.finished) work_.finished(block);
      reduce(block);
      ++count;
    }
    all_.is_used_ = true;
    all_.tell(fmt::format("{} of {} blocks of the {} are taken from {}", count, work_.blocks, work_.name,
                          all_.path_.string()));
  }

  void finish(std::size_t block) {
    if (work_.finished) work_.finished(block);
    if (is_written_) {
      append(block);
      return;
    }
    not_written_.push_back(block);
    const double elapsed = all_.seconds() - begin_s_, done = static_cast<double>(not_written_.size());
    const double remaining = elapsed * (static_cast<double>(open_) - done) / done;
    if (all_.seconds() < all_.options_.after_s) return;
    if (!work_.is_followed && remaining < all_.options_.remaining_s) return;
    all_.begin_to_write();
    is_written_ = true;
    for (const std::size_t earlier : not_written_) append(earlier);
    not_written_.clear();
  }

  void reduce(std::size_t block) const {
    if (work_.reduce) work_.reduce(block);
  }

  void append(std::size_t block) {
    std::vector<std::byte> results;
    work_.pack(block, results);
    all_.append(fingerprint(), block, results);
    reduce(block);
  }

  WorkCheckpoint& all_;
  const NumberedWork& work_;
  NumberedWork rest_;
  std::optional<std::uint64_t> fingerprint_;
  double begin_s_;
  std::size_t open_ = 0;
  bool is_written_ = false;
  std::vector<std::size_t> not_written_;  // finished blocks as long as the file is not wanted
};

WorkCheckpoint::WorkCheckpoint(const fs::path& output, CheckpointOptions options)
    : path_(unfinished_name(output)), options_(std::move(options)), file_(std::make_unique<Descriptor>()) {}

bool WorkCheckpoint::fits(const fs::path& output) {
  if (output.empty() || output == "-") return false;
  std::error_code ignored;
  const fs::file_status status = fs::status(output, ignored);
  return !fs::exists(status) || fs::is_directory(status) || fs::is_regular_file(status);
}

WorkCheckpoint::~WorkCheckpoint() = default;

double WorkCheckpoint::seconds() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - *begin_).count();
}

void WorkCheckpoint::tell(const std::string& sentence) const {
  if (options_.tell) options_.tell(sentence);
}

std::string WorkCheckpoint::header() const { return std::string(kKindOfFile) + options_.version + "\n"; }

void WorkCheckpoint::work(const NumberedWork& work, const WorkDriver& driver) {
  if (!work.is_kept) return do_work(driver, work);
  if (!begin_) begin_ = std::chrono::steady_clock::now();
  if (!has_looked_) open_existing();
  OneWork one(*this, work);
  do_work(driver, one.rest());
  one.end();
}

void WorkCheckpoint::open_existing() {
  has_looked_ = true;
  for (;;) {
    *file_ = Descriptor(::open(path_.c_str(), O_RDWR | O_NOFOLLOW | O_CLOEXEC));
    if (!file_->is_open()) {
      if (errno == ENOENT || errno == ENOTDIR) return;
      fail_to_write(path_, errno);
    }
    if (!lock_if_free(*file_)) {
      throw InputError({.file = path_.string()}, "another process works on these results and has not finished",
                       "another output, or that process to end");
    }
    if (is_named(*file_, path_)) break;
  }
  read_records();
}

void WorkCheckpoint::read_records() {
  const std::size_t size = size_of(*file_);
  std::string begin(std::min(size, header().size()), ' ');
  read_at(*file_, 0, begin.data(), begin.size());
  if (begin.substr(0, kKindOfFile.size()) != kKindOfFile.substr(0, begin.size())) {
    throw InputError({.file = path_.string()}, "is no unfinished work of abbe",
                     "that file under another name, or another output");
  }
  if (begin != header()) return;  // of another version, or nothing
  whole_ = begin.size();
  for (std::string record;;) {
    RecordHead head{};
    if (size - whole_ < sizeof(head) + kChecksumBytes) break;
    read_at(*file_, whole_, reinterpret_cast<char*>(head.data()), sizeof(head));
    if (head[2] > size - whole_ - sizeof(head) - kChecksumBytes) break;
    record.resize(sizeof(head) + head[2]);
    std::uint32_t checksum = 0;
    if (!read_at(*file_, whole_, record.data(), record.size()) ||
        !read_at(*file_, whole_ + record.size(), reinterpret_cast<char*>(&checksum), kChecksumBytes) ||
        checksum != crc32c(record)) {
      break;
    }
    found_[head[0]].try_emplace(head[1], Place{whole_ + sizeof(head), head[2]});
    whole_ += record.size() + kChecksumBytes;
  }
}

void WorkCheckpoint::begin_to_write() {
  if (is_written_) return;
  is_written_ = true;
  if (!file_->is_open()) {
    std::error_code error;
    if (path_.has_parent_path()) fs::create_directories(path_.parent_path(), error);
    if (error) fail_to_write(path_, error.value());
    *file_ = Descriptor(::open(path_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666));
    if (!file_->is_open() && errno != EEXIST) fail_to_write(path_, errno);
    if (!file_->is_open() || !lock_if_free(*file_) || !is_named(*file_, path_)) {
      throw InputError({.file = path_.string()}, "another process has begun to work on these results",
                       "another output, or that process to end");
    }
  } else if (found_.empty()) {
    if (size_of(*file_) > 0) tell(fmt::format("{} is of another version or damaged, and is replaced", path_.string()));
    whole_ = 0;
  } else if (!is_used_) {
    // Work that was done within after_s is not in the file, though work that follows may be.
    tell(fmt::format(
        "no block in {} fits so far: its blocks belong to other inputs or to later work, and are kept until "
        "all is done",
        path_.string()));
  }
  // What a killed process has written in part goes.
  if (::ftruncate(file_->number(), static_cast<off_t>(whole_)) != 0) fail_to_write(path_, errno);
  ::lseek(file_->number(), static_cast<off_t>(whole_), SEEK_SET);
  if (whole_ > 0) return;
  if (const int error = write_all(file_->number(), header())) fail_to_write(path_, error);
  whole_ = header().size();
}

void WorkCheckpoint::append(std::uint64_t work, std::size_t block, const std::vector<std::byte>& results) {
  const RecordHead head{work, block, results.size()};
  std::string record(reinterpret_cast<const char*>(head.data()), sizeof(head));
  record.append(reinterpret_cast<const char*>(results.data()), results.size());
  const std::uint32_t checksum = crc32c(record);
  record.append(reinterpret_cast<const char*>(&checksum), kChecksumBytes);
  if (const int error = write_all(file_->number(), record)) {
    // The records before stay as they are.
    if (::ftruncate(file_->number(), static_cast<off_t>(whole_)) != 0) fail_to_write(path_, errno);
    fail_to_write(path_, error);
  }
  whole_ += record.size();
}

std::vector<std::byte> WorkCheckpoint::read(const Place& place) const {
  std::vector<std::byte> results(place.size);
  if (!read_at(*file_, place.at, reinterpret_cast<char*>(results.data()), place.size)) {
    throw InputError({.file = path_.string()}, "cannot be read", "that file as it was a moment ago");
  }
  return results;
}

void WorkCheckpoint::remove() {
  if (!file_->is_open()) return;
  if (!is_used_ && !is_written_) {
    tell(fmt::format("{} was of other inputs or of another version, and is removed", path_.string()));
  }
  ::unlink(path_.c_str());
  file_->close();
}

}  // namespace abbe
