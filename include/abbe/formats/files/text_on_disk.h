#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

namespace abbe {

/// A long text of a folder of results that is written to the disk while it is made, by a thread of its own, so that the
/// disk works meanwhile and the text needs no memory. ResultsFolder::write() gives it a name.
///
/// Until then its file has no name, so a killed process leaves nothing behind. Where the file system has no such files
/// (O_TMPFILE), the text is kept in memory.
class TextOnDisk {
 public:
  /// @param results  the folder of results; it need not exist yet
  explicit TextOnDisk(const std::filesystem::path& results);
  ~TextOnDisk();
  TextOnDisk(TextOnDisk&&) noexcept;
  TextOnDisk& operator=(TextOnDisk&&) noexcept;

  /// Returns before the text is written. If that fails, ResultsFolder::write() says so.
  void append(std::string text);
  /// Begins again.
  void clear();
  /// append() as a function, for as long as this object lives; an empty text stands for clear().
  std::function<void(std::string text)> taker();

 private:
  friend class ResultsFolder;
  class Writer;

  /// Puts the whole text, flushed, into a new file. @param called  what messages call it. @throws InputError
  void put_at(const std::filesystem::path& path, const std::filesystem::path& called);

  std::unique_ptr<Writer> writer_;
};

}  // namespace abbe
