#include "abbe/formats/files/remove_unfinished.h"

#include <system_error>
#include <vector>

#include "abbe/formats/files/results_marker.h"

namespace abbe {

namespace fs = std::filesystem;

void remove_unfinished(const fs::path& path) {
  std::error_code ignored;
  if (fs::is_directory(fs::symlink_status(path, ignored))) {
    std::vector<fs::path> others;
    std::error_code error;
    for (fs::directory_iterator entry(path, error), end; !error && entry != end; entry.increment(error)) {
      const fs::path name = entry->path().filename();
      if (name != kBeingWritten && name != ResultsMarker::kName) others.push_back(entry->path());
    }
    for (const fs::path& other : others) {
      fs::remove_all(other, error);
      // Still to be removed, so it must stay known as unfinished.
      if (error) return;
    }
    fs::remove(path / kBeingWritten, ignored);
    fs::remove(path / ResultsMarker::kName, ignored);
  }
  fs::remove(path, ignored);
}

}  // namespace abbe
