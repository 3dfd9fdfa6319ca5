#include "abbe/formats/files/text_on_disk.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "abbe/formats/files/unfinished_output.h"
#include "abbe/formats/files/write_error.h"

namespace abbe {
namespace {

namespace fs = std::filesystem;

/// @returns errno, 0 if done
int copy_file(int from, int to) {
  std::vector<char> bytes(std::size_t{1} << 20U);
  for (off_t at = 0;;) {
    const ssize_t read = ::pread(from, bytes.data(), bytes.size(), at);
    if (read < 0 && errno == EINTR) continue;
    if (read < 0) return errno;
    if (read == 0) return 0;
    if (const int error = write_all(to, {bytes.data(), static_cast<std::size_t>(read)})) return error;
    at += read;
  }
}

}  // namespace

/// The file, and the thread that writes to it.
class TextOnDisk::Writer {
 public:
  explicit Writer(const fs::path& results) : file_(nameless_file(existing_folder_above(resolved_output(results)))) {
    if (file_.is_open()) thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
  }

  ~Writer() {
    // What is thrown away need not be written.
    const std::lock_guard lock(mutex_);
    waiting_.clear();
  }

  void append(std::string text) {
    if (text.empty()) return;
    const std::lock_guard lock(mutex_);
    if (error_ != 0) return;
    waiting_.push_back(std::move(text));
    if (file_.is_open()) added_.notify_one();
  }

  void clear() {
    std::unique_lock lock(mutex_);
    waiting_.clear();
    wait(lock);
    if (error_ == 0 && file_.is_open() &&
        (::ftruncate(file_.number(), 0) != 0 || ::lseek(file_.number(), 0, SEEK_SET) != 0)) {
      error_ = errno;
    }
  }

  void put_at(const fs::path& path, const fs::path& called) {
    std::unique_lock lock(mutex_);
    wait(lock);
    if (error_ != 0) fail_to_write(called, error_);
    if (file_.is_open()) {
      if (::fsync(file_.number()) != 0) fail_to_write(called, errno);
      if (give_name(file_, path) == 0) return;
    }
    // In memory, or on a file system other than that of the folder.
    Descriptor named(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666));
    if (!named.is_open()) fail_to_write(called, errno);
    if (file_.is_open()) {
      if (const int error = copy_file(file_.number(), named.number())) fail_to_write(called, error);
    }
    for (const std::string& text : waiting_) {
      if (const int error = write_all(named.number(), text)) fail_to_write(called, error);
    }
    if (::fsync(named.number()) != 0) fail_to_write(called, errno);
    if (const int error = named.close()) fail_to_write(called, error);
  }

 private:
  /// Waits until all that was given is in the file, or could not be written.
  void wait(std::unique_lock<std::mutex>& lock) {
    if (!file_.is_open()) return;
    written_.wait(lock, [this] { return error_ != 0 || (waiting_.empty() && !is_writing_); });
  }

  void run(const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    while (added_.wait(lock, stop, [this] { return !waiting_.empty(); })) {
      const std::string text = std::move(waiting_.front());
      waiting_.pop_front();
      is_writing_ = true;
      lock.unlock();
      const int error = write_all(file_.number(), text);
      // The disk begins; how it ends is what fsync() says.
      ::sync_file_range(file_.number(), 0, 0, SYNC_FILE_RANGE_WRITE);
      lock.lock();
      is_writing_ = false;
      error_ = error;
      written_.notify_all();
      if (error != 0) return;
    }
  }

  Descriptor file_;  // not open: the text stays in `waiting_`
  std::mutex mutex_;
  std::condition_variable_any added_, written_;
  std::deque<std::string> waiting_;
  int error_ = 0;
  bool is_writing_ = false;
  std::jthread thread_;
};

TextOnDisk::TextOnDisk(const fs::path& results) : writer_(std::make_unique<Writer>(results)) {}
TextOnDisk::~TextOnDisk() = default;
TextOnDisk::TextOnDisk(TextOnDisk&&) noexcept = default;
TextOnDisk& TextOnDisk::operator=(TextOnDisk&&) noexcept = default;

void TextOnDisk::append(std::string text) { writer_->append(std::move(text)); }
void TextOnDisk::clear() { writer_->clear(); }

std::function<void(std::string text)> TextOnDisk::taker() {
  return [writer = writer_.get()](std::string text) {
    if (text.empty()) return writer->clear();
    writer->append(std::move(text));
  };
}

void TextOnDisk::put_at(const fs::path& path, const fs::path& called) { writer_->put_at(path, called); }

}  // namespace abbe
