#include "abbe/formats/files/standard_input.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <string>
#include <string_view>
#include <system_error>

#include "abbe/formats/files/unfinished_output.h"
#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

std::atomic<bool> accepted = false;

[[noreturn]] void refuse(const char* problem, int error) {
  throw InputError({.file = kStandardInput},
                   fmt::format("cannot be {}: {}", problem, std::generic_category().message(error)));
}

/// Of a descriptor that stays open; other processes, such as the reader of STEP files, can open it too.
std::filesystem::path path_of(int descriptor) { return fmt::format("/proc/{}/fd/{}", ::getpid(), descriptor); }

std::filesystem::path kept_standard_input() {
  struct stat status {};
  const std::filesystem::path itself = path_of(STDIN_FILENO);
  const bool is_file = ::fstat(STDIN_FILENO, &status) == 0 && S_ISREG(status.st_mode);
  // Not where somebody else has read a part of it, or where only the descriptor may be read.
  if (is_file && ::lseek(STDIN_FILENO, 0, SEEK_CUR) == 0 && ::access(itself.c_str(), R_OK) == 0) return itself;
  std::FILE* const kept = std::tmpfile();
  if (kept == nullptr) refuse("kept in a temporary file", errno);
  std::array<char, 1 << 16> block;
  for (ssize_t size = 0; (size = ::read(STDIN_FILENO, block.data(), block.size())) != 0;) {
    if (size < 0 && errno == EINTR) continue;
    const int error = size < 0 ? errno : write_all(::fileno(kept), {block.data(), static_cast<std::size_t>(size)});
    if (error == 0) continue;
    std::fclose(kept);
    refuse(size < 0 ? "read" : "kept in a temporary file", error);
  }
  return path_of(::fileno(kept));
}

}  // namespace

void accept_standard_input() { accepted = true; }

std::filesystem::path path_to_open(const std::filesystem::path& path) {
  if (!accepted || path != kStandardInput) return path;
  static const std::filesystem::path kept = kept_standard_input();
  return kept;
}

}  // namespace abbe
