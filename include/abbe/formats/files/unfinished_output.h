#pragma once

// For formats and the command: files and folders that are being written.
#include <filesystem>
#include <functional>
#include <optional>
#include <string_view>

#include "abbe/formats/files/interruption.h"

namespace abbe {

/// The path that the name of an output means: absolute, without links and "..". It is resolved once, before anything is
/// made, so that "new/../results" is the folder "results" whether or not "new" exists.
std::filesystem::path resolved_output(const std::filesystem::path& name);

/// resolved_output() of a file. @throws InputError for a folder, device, pipe or socket, which a new file would replace
/// instead of being written to it
std::filesystem::path file_to_write(const std::filesystem::path& name);

/// The folder in which a file or folder is made; of those that are not there yet, the one in which they are made.
std::filesystem::path existing_folder_above(const std::filesystem::path& path);

/// For commands before they begin to compute: whether a new file or folder can be made in a folder. What only shows
/// when it is made, such as a full disk, is left to the writer, whose message this is.
/// @param folder  resolved
/// @param called  what messages call the output
/// @throws InputError if the folder does not exist, is none or may not be written to
void check_folder_to_write_in(const std::filesystem::path& folder, const std::filesystem::path& called);

/// File descriptor that is closed on every path.
class Descriptor {
 public:
  explicit Descriptor(int number = -1) : number_(number) {}
  ~Descriptor() { close(); }
  Descriptor(Descriptor&& other) noexcept : number_(other.number_) { other.number_ = -1; }
  Descriptor& operator=(Descriptor&& other) noexcept;
  int number() const { return number_; }
  bool is_open() const { return number_ >= 0; }
  /// @returns errno, 0 if done
  int close();

 private:
  int number_;
};

/// A file in a folder that has no name, so that a killed process leaves nothing behind. Not open where the file system
/// has no such files.
Descriptor nameless_file(const std::filesystem::path& folder);

/// Gives such a file a name that nothing has, on its own file system. @returns errno, 0 if done
int give_name(const Descriptor& nameless, const std::filesystem::path& path);

inline constexpr std::string_view kUnfinished = ".abbe-unfinished";  ///< what is being written
inline constexpr std::string_view kOlder = ".abbe-older";            ///< a folder of results that was moved aside

/// A name beside an output that nothing else has: ".NAME.<16 random digits><ending>".
std::filesystem::path name_beside(const std::filesystem::path& output, std::string_view ending);

/// A new file or folder beside an output, under name_beside(output, kUnfinished).
///
/// A lock (flock) says that its writer lives, also to processes of another container, whose numbers mean nothing here.
/// The destructor removes it unless it was released; so does an interruption (interruption.h).
class UnfinishedOutput {
 public:
  enum class Kind { file, folder };

  /// @param output  resolved
  /// @param called  the name by which messages call it
  /// @throws InputError if it cannot be made
  UnfinishedOutput(const std::filesystem::path& output, Kind kind, const std::filesystem::path& called);
  ~UnfinishedOutput();
  UnfinishedOutput(const UnfinishedOutput&) = delete;
  UnfinishedOutput& operator=(const UnfinishedOutput&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// Descriptor of the file, open for writing, or of the folder.
  int descriptor() const { return held_.number(); }
  /// The file or folder has been renamed to its final name, or removed.
  void release();

 private:
  int make(Kind kind);

  std::filesystem::path output_, path_;
  std::optional<UnfinishedPath> noted_;
  Descriptor held_;
};

/// Calls `found` with everything that earlier writers of this output left behind and nobody works on any more; its lock
/// is held meanwhile.
/// @param output  resolved
/// @param ending  kUnfinished or kOlder
void for_abandoned(const std::filesystem::path& output, std::string_view ending,
                   const std::function<void(const std::filesystem::path&)>& found);

/// OUTPUT.unfinished of an output: where long work is kept until the output is complete.
std::filesystem::path unfinished_name(const std::filesystem::path& output);

/// Locks an open file or folder, for as long as it is open. @returns whether nobody else had it locked
bool lock_if_free(const Descriptor& file);

/// Whether an open file or folder still has this name: whoever was done with it may have removed it.
bool is_named(const Descriptor& file, const std::filesystem::path& path);

/// Writes all of it. @returns errno, 0 if done
int write_all(int file, std::string_view contents);

/// Moves a finished file or folder to a name that nothing has, in one step where the file system can. @returns errno, 0
/// if done
int rename_to_new(const std::filesystem::path& from, const std::filesystem::path& to);

/// Flushes the entries of a folder to the disk. @returns errno, 0 if done
int flush_folder(const std::filesystem::path& folder);

}  // namespace abbe
