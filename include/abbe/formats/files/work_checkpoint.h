#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "abbe/geometry/numbered_work.h"

namespace abbe {

class Descriptor;

struct CheckpointOptions {
  std::string version{};   ///< of the program: blocks of another one are not used
  double after_s = 2;      ///< nothing is written before numbered work has taken so long
  double remaining_s = 2;  ///< nor if it will probably be done in less
  std::function<void(const std::string& sentence)> tell{};  ///< what the user has to know
};

/// Finished blocks of numbered work in the file OUTPUT.unfinished, so that the same command goes on from there after it
/// was killed (docs/scale.md).
///
/// Short work makes no file. A file is locked while a process works on it. Blocks are used again only if their work
/// has the same fingerprint; what a killed process has written in part is not used.
class WorkCheckpoint {
 public:
  /// Whether there can be such a file: not for an output without a name, a device or a pipe.
  static bool fits(const std::filesystem::path& output);

  /// @param output  the file or folder that the command writes
  WorkCheckpoint(const std::filesystem::path& output, CheckpointOptions options);
  ~WorkCheckpoint();
  WorkCheckpoint(const WorkCheckpoint&) = delete;
  WorkCheckpoint& operator=(const WorkCheckpoint&) = delete;

  /// Lets `driver` compute the blocks that the file does not have, and writes them.
  /// @throws InputError if another process works on the file, it is none of this kind, or cannot be written
  void work(const NumberedWork& work, const WorkDriver& driver);

  /// Call when the output is complete: removes the file.
  void remove();

  const std::filesystem::path& path() const { return path_; }

 private:
  class OneWork;
  struct Place {
    std::size_t at, size;  ///< of the results in the file
  };

  void open_existing();
  void read_records();
  void begin_to_write();
  void append(std::uint64_t work, std::size_t block, const std::vector<std::byte>& results);
  std::vector<std::byte> read(const Place& place) const;
  std::string header() const;
  double seconds() const;
  void tell(const std::string& sentence) const;

  std::filesystem::path path_;
  CheckpointOptions options_;
  std::unique_ptr<Descriptor> file_;
  std::map<std::uint64_t, std::map<std::size_t, Place>> found_;  // by fingerprint and block
  std::size_t whole_ = 0;                                        // bytes of the file that are whole records
  bool has_looked_ = false, is_used_ = false, is_written_ = false;
  std::optional<std::chrono::steady_clock::time_point> begin_;
};

}  // namespace abbe
