// Loaded before a program (LD_PRELOAD): a slow disk. A call that reads returns fewer bytes than it was asked for, now
// and then none because a signal came first (EINTR), and some of the calls take a while.
//
//   ABBE_SLOW_COUNT=file     how many calls got less than they asked for, written at the end
#include <dlfcn.h>
#include <sys/types.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstdlib>

namespace {

std::atomic<long> calls{0}, shortened{0};

template <typename Function>
Function real(const char* name) {
  return reinterpret_cast<Function>(::dlsym(RTLD_NEXT, name));
}

/// Bytes that a call gets this time, at least one; 0: it is interrupted.
size_t share(size_t wanted) {
  const long call = ++calls;
  if (call % 50 == 0) ::usleep(1000);
  if (call % 5 == 0) return 0;
  // A prime number of bytes: rows and numbers are cut anywhere.
  constexpr size_t kMost[] = {4093, 1, 61, 16381};
  const size_t got = std::min(wanted, kMost[call % 4]);
  if (got < wanted) ++shortened;
  return got;
}

struct AtTheEnd {
  ~AtTheEnd() {
    const char* const file = std::getenv("ABBE_SLOW_COUNT");
    if (file == nullptr) return;
    if (std::FILE* out = std::fopen(file, "we")) {
      std::fprintf(out, "%ld\n", shortened.load());
      std::fclose(out);
    }
  }
} at_the_end;

}  // namespace

extern "C" {

ssize_t read(int file, void* data, size_t size) {
  const auto next = real<ssize_t (*)(int, void*, size_t)>("read");
  if (size == 0) return next(file, data, size);
  const size_t got = share(size);
  if (got > 0) return next(file, data, got);
  errno = EINTR;
  return -1;
}
ssize_t pread(int file, void* data, size_t size, off_t offset) {
  const auto next = real<ssize_t (*)(int, void*, size_t, off_t)>("pread");
  if (size == 0) return next(file, data, size, offset);
  const size_t got = share(size);
  if (got > 0) return next(file, data, got, offset);
  errno = EINTR;
  return -1;
}
ssize_t pread64(int file, void* data, size_t size, off_t offset) { return pread(file, data, size, offset); }

}  // extern "C"
