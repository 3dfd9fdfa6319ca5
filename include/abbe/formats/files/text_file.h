#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "abbe/formats/files/mapped_inputs.h"

namespace abbe {

/// Whole contents of a regular file. @throws InputError if it is missing, cannot be read, is no regular file or is
/// empty
std::string read_text_file(const std::filesystem::path& path);

/// The same for one of our own kinds of files. @param ending  of its names: ".machine.toml"
/// @throws InputError also if the name says that the file is of another kind
std::string read_file_of_kind(const std::filesystem::path& path, std::string_view ending);

/// A regular file in memory for reading once, without a copy. A file that is cut short meanwhile ends the process
/// (mapped_inputs.h). @throws InputError as read_text_file()
class MappedFile {
 public:
  explicit MappedFile(const std::filesystem::path& path);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  std::string_view text() const { return {data_, size_}; }
  /// What was read before `end` needs no memory any more; reading it again is right but slow.
  void forget(std::size_t end);

 private:
  const char* data_ = nullptr;
  std::size_t size_ = 0;
  std::size_t forgotten_ = 0;
  std::optional<MappedInput> named_;
};

}  // namespace abbe
