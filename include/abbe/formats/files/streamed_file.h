#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string_view>

namespace abbe {

class UnfinishedOutput;
class Descriptor;

/// A file that is written piece by piece and appears whole or not at all; an older file of that name stays until then,
/// and for good where existing_output.h says so.
///
/// Until commit() the file has no name where the file system can do that, so that a killed or interrupted process
/// leaves nothing behind; elsewhere it stands beside the older one (unfinished_output.h) and the next writer of that
/// name removes it if its own was killed.
class StreamedFile {
 public:
  /// @throws InputError if the file cannot be made
  explicit StreamedFile(const std::filesystem::path& name);
  ~StreamedFile();
  StreamedFile(const StreamedFile&) = delete;
  StreamedFile& operator=(const StreamedFile&) = delete;

  /// @throws InputError if it cannot be written whole
  void append(std::string_view contents);
  /// Writes over what was written before, such as a header whose numbers are known at the end. @throws InputError
  void overwrite(std::size_t offset, std::string_view contents);
  /// Flushes and makes the file visible under its name. @throws InputError; an older file is then still there
  void commit();

 private:
  int file() const;
  void put_in_place(const std::filesystem::path& from);

  std::filesystem::path name_;            ///< as it was given
  std::filesystem::path path_;            ///< resolved
  std::unique_ptr<Descriptor> nameless_;  ///< one of these two
  std::unique_ptr<UnfinishedOutput> unfinished_;
};

}  // namespace abbe
