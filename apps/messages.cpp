#include "messages.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <string>

#include "abbe/formats/files/unfinished_output.h"
#include "abbe/formats/text/utf8.h"

namespace abbe {
namespace {

bool quiet = false, without_text = false;

/// Never destroyed: streams are flushed after everything else at the end of the process.
PrintableText& standard_output_text() {
  static auto* const text = new PrintableText;
  return *text;
}

/// The write function of a stream. @returns `size`, or 0 and errno
ssize_t write_printable(void* /*stream*/, const char* data, std::size_t size) {
  if (without_text) return static_cast<ssize_t>(size);
  const std::string shown = standard_output_text().next({data, size});
  errno = write_all(STDOUT_FILENO, shown);
  return errno == 0 ? static_cast<ssize_t>(size) : 0;
}

}  // namespace

void tell_text(std::string_view text) { draw(printable(text, text.size())); }

void draw(std::string_view text) {
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

void be_quiet(bool without_text_too) {
  quiet = true;
  without_text = without_text_too;
}

bool is_quiet() { return quiet; }

void print_file(std::string_view contents) {
  const bool before = without_text;
  std::fflush(stdout);
  without_text = false;
  std::fwrite(contents.data(), 1, contents.size(), stdout);
  std::fflush(stdout);
  without_text = before;
}

void keep_numbers_of_standard_streams() {
  for (const int number : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(number, F_GETFD) != -1) continue;
    // open() takes the smallest number that is free, which is this one.
    ::open("/dev/null", number == STDIN_FILENO ? O_WRONLY : O_RDONLY);
  }
}

void make_standard_output_printable() {
  standard_output_text();
  std::FILE* const stream = ::fopencookie(nullptr, "w", {nullptr, write_printable, nullptr, nullptr});
  if (stream == nullptr) return;
  std::setvbuf(stream, nullptr, ::isatty(STDOUT_FILENO) == 1 ? _IOLBF : _IOFBF, BUFSIZ);
  stdout = stream;
}

int flush_standard_output() {
  if (std::fflush(stdout) != 0) return EOF;
  errno = write_all(STDOUT_FILENO, standard_output_text().rest());
  return errno == 0 ? 0 : EOF;
}

}  // namespace abbe
