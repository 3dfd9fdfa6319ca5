#pragma once

#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace abbe {

class TextOnDisk;
class UnfinishedOutput;

/// Whether results may be written under a name: a new or an empty folder, or one that holds results already, as the
/// file ".abbe-results" in it says, and a place where it and the folders on its way can be made. For commands before
/// they begin to compute.
/// @throws InputError for a file, a folder with other files, or a place that may not be written to
void check_results_folder(const std::filesystem::path& name);

/// A folder of results that appears whole or not at all.
///
/// Everything is written to a folder beside it (unfinished_output.h); commit() flushes that to the disk and exchanges
/// it with an older result in one step, so that after a full disk or a killed process the older one is intact, and of
/// two writers at once one is there, whole. Files in the older folder that its ".abbe-results" does not list are
/// somebody's and stay. Without commit() the destructor removes what was written, as an interruption does
/// (interruption.h). What killed processes left behind is removed by the next writer of that name.
class ResultsFolder {
 public:
  /// @throws InputError if the folder cannot be made, as check_results_folder()
  explicit ResultsFolder(std::filesystem::path name);
  ~ResultsFolder();
  ResultsFolder(const ResultsFolder&) = delete;
  ResultsFolder& operator=(const ResultsFolder&) = delete;

  const std::filesystem::path& name() const { return name_; }

  /// Writes and flushes one file; makes the folders in `relative`.
  /// @throws InputError if it cannot be written whole, or the name leads out of the folder
  void write(const std::filesystem::path& relative, std::string_view contents);
  /// The same of a text that was written to the disk while it was made.
  void write(const std::filesystem::path& relative, TextOnDisk text);

  /// Makes the result visible under its name. @throws InputError; the older result is then still there
  void commit();

 private:
  std::filesystem::path place_of(const std::filesystem::path& relative);
  void refuse_to_lose_files() const;
  void put_in_place();

  std::filesystem::path name_;  ///< as it was given
  std::filesystem::path path_;  ///< resolved
  std::unique_ptr<UnfinishedOutput> unfinished_;
  std::set<std::string> files_;
};

/// Files, by names and contents, as a folder of results. @throws InputError as ResultsFolder
void write_result_files(const std::filesystem::path& folder,
                        const std::vector<std::pair<std::string, std::string>>& files);

/// One file that appears whole or not at all; an older file of that name stays until then. Through a link the file it
/// leads to is written. @throws InputError, also where the name is that of a folder or a device, or of a file that is
/// to stay (existing_output.h)
void write_file_atomically(const std::filesystem::path& name, std::string_view contents);

}  // namespace abbe
