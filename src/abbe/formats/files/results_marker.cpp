#include "abbe/formats/files/results_marker.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <sstream>
#include <system_error>
#include <vector>

#include "abbe/formats/files/unfinished_output.h"

namespace abbe {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kFirstLine =
    "Results of abbe: the next ones written here replace the files below and leave others alone.";
constexpr std::string_view kFirstLineOfAll =
    "Results of abbe: the next ones written here replace this folder as a whole.";
constexpr std::size_t kLongest = std::size_t{64} << 20U;

/// Text of a regular file of at most kLongest bytes; links are not followed.
std::optional<std::string> text_of(const fs::path& path) {
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  struct stat status {};
  if (!file.is_open() || ::fstat(file.number(), &status) != 0 || !S_ISREG(status.st_mode)) return std::nullopt;
  std::string text;
  char block[4096];
  for (;;) {
    const ssize_t count = ::read(file.number(), block, sizeof block);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0 || text.size() > kLongest) return std::nullopt;
    if (count == 0) return text;
    text.append(block, static_cast<std::size_t>(count));
  }
}

/// What is in a folder, sorted; nothing if it cannot be read.
std::vector<fs::path> entries(const fs::path& folder) {
  std::vector<fs::path> result;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    result.push_back(entry->path());
  }
  return result;
}

bool is_real_folder(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(fs::symlink_status(path, error));
}

bool move_from(const ResultsMarker& marker, const fs::path& older, const fs::path& newer, const std::string& within) {
  bool all = true;
  for (const fs::path& entry : entries(older / within)) {
    const std::string name = within + entry.filename().string();
    if (name == ResultsMarker::kName || marker.lists(name)) continue;
    if (is_real_folder(entry) && marker.lists_in(name)) {
      all = move_from(marker, older, newer, name + "/") && all;
      continue;
    }
    std::error_code error;
    fs::create_directories((newer / name).parent_path(), error);
    all = ::renameat2(AT_FDCWD, entry.c_str(), AT_FDCWD, (newer / name).c_str(), RENAME_NOREPLACE) == 0 && all;
  }
  return all;
}

void remove_from(const ResultsMarker& marker, const fs::path& older, const std::string& within) {
  for (const fs::path& entry : entries(older / within)) {
    const std::string name = within + entry.filename().string();
    if (is_real_folder(entry)) {
      if (marker.lists_in(name)) remove_from(marker, older, name + "/");
    } else if (marker.lists(name)) {
      ::unlink(entry.c_str());
    }
  }
  if (!within.empty()) ::rmdir((older / within).c_str());
}

}  // namespace

std::string ResultsMarker::text(const std::set<std::string>& files) {
  std::string result(kFirstLine);
  result += '\n';
  for (const std::string& file : files) result += file + "\n";
  return result;
}

std::optional<ResultsMarker> ResultsMarker::read(const fs::path& folder) {
  const std::optional<std::string> text = text_of(folder / kName);
  if (!text) return std::nullopt;
  std::istringstream lines(*text);
  std::string line;
  ResultsMarker result;
  std::getline(lines, line);
  if (line == kFirstLineOfAll) {
    result.all_ = true;
  } else if (line != kFirstLine) {
    return std::nullopt;
  }
  while (std::getline(lines, line)) {
    if (!line.empty()) result.files_.insert(line);
  }
  return result;
}

bool ResultsMarker::lists_in(const std::string& folder) const {
  const auto found = files_.lower_bound(folder + "/");
  return all_ || (found != files_.end() && found->compare(0, folder.size() + 1, folder + "/") == 0);
}

bool move_foreign_files(const fs::path& older, const fs::path& newer) {
  const std::optional<ResultsMarker> marker = ResultsMarker::read(older);
  return !marker || move_from(*marker, older, newer, "");
}

void remove_results(const fs::path& older) {
  if (const std::optional<ResultsMarker> marker = ResultsMarker::read(older)) {
    remove_from(*marker, older, "");
    // Last, so that what is left after a kill is still known for results.
    if (entries(older).size() == 1) ::unlink((older / ResultsMarker::kName).c_str());
  }
  ::rmdir(older.c_str());
}

}  // namespace abbe
