#pragma once

// Internal to formats: what says that a folder holds results.
#include <filesystem>
#include <optional>
#include <set>
#include <string>

namespace abbe {

/// The file ".abbe-results" in a folder of results, and the list of files in it that belong to them.
///
/// Results of 0.1.0 have the file without a list: all that is in the folder belongs to them, as it says there.
class ResultsMarker {
 public:
  static constexpr const char* kName = ".abbe-results";

  /// The text of the file for results of these files, names with "/" relative to the folder.
  static std::string text(const std::set<std::string>& files);
  /// Nothing where the folder has no such file.
  static std::optional<ResultsMarker> read(const std::filesystem::path& folder);

  bool lists(const std::string& file) const { return all_ || files_.count(file) != 0; }
  /// Whether files of the results lie in this folder, relative.
  bool lists_in(const std::string& folder) const;

 private:
  bool all_ = false;
  std::set<std::string> files_;
};

/// Moves what does not belong to the older results, such as notes that somebody put there, into the new ones. What has
/// a name that is taken there stays. @returns whether nothing had to stay
bool move_foreign_files(const std::filesystem::path& older, const std::filesystem::path& newer);

/// Removes the files of older results, and the folder if nothing else is in it. Links are not followed.
void remove_results(const std::filesystem::path& older);

}  // namespace abbe
