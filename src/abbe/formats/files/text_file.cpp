#include "abbe/formats/files/text_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "abbe/formats/files/kept_inputs.h"
#include "abbe/formats/files/standard_input.h"
#include "abbe/formats/text/input_error.h"

namespace abbe {

MappedFile::MappedFile(const std::filesystem::path& path) {
  const InputError::Place place{path.string(), 0, 0, ""};
  const auto fail = [&](int error) {
    throw InputError(
        place, error == ENOENT ? "there is no such file" : "cannot be read: " + std::generic_category().message(error));
  };
  const std::filesystem::path opened = path_to_open(path);
  // Not to wait for the other end of a pipe before it is known to be one.
  const int file = ::open(opened.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (file < 0) fail(errno);
  struct stat status {};
  const int problem = ::fstat(file, &status) == 0 ? 0 : errno;
  if (problem == 0 && S_ISREG(status.st_mode) && status.st_size > 0) {
    size_ = static_cast<std::size_t>(status.st_size);
    void* memory = ::mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, file, 0);
    const int error = errno;
    ::close(file);
    if (memory == MAP_FAILED) fail(error);
    ::madvise(memory, size_, MADV_WILLNEED);
    data_ = static_cast<const char*>(memory);
    named_.emplace(data_, size_, path.string());
    note_input(opened);
    return;
  }
  ::close(file);
  if (problem != 0) fail(problem);
  if (S_ISDIR(status.st_mode)) throw InputError(place, "is a folder", "a file");
  throw InputError(place, S_ISREG(status.st_mode) ? "the file is empty" : "is not a regular file");
}

MappedFile::~MappedFile() {
  if (data_ != nullptr) ::munmap(const_cast<char*>(data_), size_);
}

void MappedFile::forget(std::size_t end) {
  const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  end = end < size_ ? end / page * page : size_;
  if (end <= forgotten_) return;
  // The pages of a file come back from the file if they are read again.
  ::madvise(const_cast<char*>(data_) + forgotten_, end - forgotten_, MADV_DONTNEED);
  forgotten_ = end;
}

std::string read_text_file(const std::filesystem::path& path) { return std::string(MappedFile(path).text()); }

std::string read_file_of_kind(const std::filesystem::path& path, std::string_view ending) {
  constexpr std::string_view kEndings[] = {".machine.toml",   ".errors.toml",      ".study.toml",
                                           ".placement.toml", ".positioning.toml", ".import.toml"};
  const std::string name = path.filename().string();
  const std::string text = read_text_file(path);
  for (const std::string_view other : kEndings) {
    const bool has_ending = name.ends_with(other) || name == other.substr(1);  // errors.toml, as `abbe run` writes it
    if (other == ending || !has_ending) continue;
    throw InputError({.file = path.string()}, "has the name of another kind of file",
                     "a file named *" + std::string(ending));
  }
  return text;
}

}  // namespace abbe
