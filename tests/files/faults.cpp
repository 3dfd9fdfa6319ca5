// Loaded before a program (LD_PRELOAD): the n-th of its calls that change files fails, or ends it.
//
//   ABBE_FAULT=n:EIO | n:ENOSPC | n:KILL        n from 1 on
//   ABBE_FAULT_COUNT=file                       how many such calls there were, written at the end
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/types.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

std::atomic<long> calls{0};

struct Fault {
  long at = 0;
  int error = 0;  // 0: the process is killed
};

Fault read_fault() {
  const char* const text = std::getenv("ABBE_FAULT");
  if (text == nullptr) return {};
  char* word = nullptr;
  const long at = std::strtol(text, &word, 10);
  if (std::strcmp(word, ":EIO") == 0) return {at, EIO};
  if (std::strcmp(word, ":ENOSPC") == 0) return {at, ENOSPC};
  return {at, 0};
}

/// Whether this call fails; errno is set.
bool fails() {
  static const Fault fault = read_fault();
  if (++calls != fault.at) return false;
  if (fault.error == 0) ::kill(::getpid(), SIGKILL);
  errno = fault.error;
  return true;
}

template <typename Function>
Function next(const char* name) {
  return reinterpret_cast<Function>(::dlsym(RTLD_NEXT, name));
}

struct AtTheEnd {
  ~AtTheEnd() {
    const char* const file = std::getenv("ABBE_FAULT_COUNT");
    if (file == nullptr) return;
    if (std::FILE* out = std::fopen(file, "we")) {
      std::fprintf(out, "%ld\n", calls.load());
      std::fclose(out);
    }
  }
} at_the_end;

}  // namespace

extern "C" {

int open(const char* path, int flags, ...) {
  mode_t mode = 0;
  if ((flags & (O_CREAT | O_TMPFILE)) != 0) {
    va_list rest;
    va_start(rest, flags);
    mode = va_arg(rest, mode_t);
    va_end(rest);
    if ((flags & O_ACCMODE) != O_RDONLY && fails()) return -1;
  }
  return next<int (*)(const char*, int, ...)>("open")(path, flags, mode);
}
ssize_t write(int file, const void* data, size_t size) {
  // What is said is not what is kept.
  if (file > STDERR_FILENO && fails()) return -1;
  return next<ssize_t (*)(int, const void*, size_t)>("write")(file, data, size);
}
ssize_t pwrite(int file, const void* data, size_t size, off_t offset) {
  return fails() ? -1 : next<ssize_t (*)(int, const void*, size_t, off_t)>("pwrite")(file, data, size, offset);
}
int fsync(int file) { return fails() ? -1 : next<int (*)(int)>("fsync")(file); }
int mkdir(const char* path, mode_t mode) {
  return fails() ? -1 : next<int (*)(const char*, mode_t)>("mkdir")(path, mode);
}
int rename(const char* from, const char* to) {
  return fails() ? -1 : next<int (*)(const char*, const char*)>("rename")(from, to);
}
int renameat2(int from_folder, const char* from, int to_folder, const char* to, unsigned flags) {
  return fails() ? -1
                 : next<int (*)(int, const char*, int, const char*, unsigned)>("renameat2")(from_folder, from,
                                                                                            to_folder, to, flags);
}
int linkat(int from_folder, const char* from, int to_folder, const char* to, int flags) {
  return fails() ? -1
                 : next<int (*)(int, const char*, int, const char*, int)>("linkat")(from_folder, from, to_folder, to,
                                                                                    flags);
}
int unlink(const char* path) { return fails() ? -1 : next<int (*)(const char*)>("unlink")(path); }
int unlinkat(int folder, const char* path, int flags) {
  return fails() ? -1 : next<int (*)(int, const char*, int)>("unlinkat")(folder, path, flags);
}
int rmdir(const char* path) { return fails() ? -1 : next<int (*)(const char*)>("rmdir")(path); }
int remove(const char* path) { return fails() ? -1 : next<int (*)(const char*)>("remove")(path); }

}  // extern "C"
