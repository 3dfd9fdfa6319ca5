#include "abbe/formats/files/kept_inputs.h"

#include <sys/stat.h>

#include <algorithm>
#include <atomic>
#include <mutex>
#include <system_error>
#include <vector>

#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

namespace fs = std::filesystem;

struct Input {
  dev_t device;
  ino_t number;
  fs::path name;      // as it was given
  fs::path resolved;  // without links
};

struct Inputs {
  std::atomic<bool> kept = false;
  std::mutex list;
  std::vector<Input> all;
};

Inputs& inputs() {
  static Inputs one;
  return one;
}

/// Whether the resolved name of a file begins with that of the folder.
bool lies_in(const fs::path& file, const fs::path& folder) {
  return std::mismatch(folder.begin(), folder.end(), file.begin(), file.end()).first == folder.end();
}

}  // namespace

KeptInputs::KeptInputs() { inputs().kept = true; }

KeptInputs::~KeptInputs() {
  inputs().kept = false;
  const std::lock_guard<std::mutex> locked(inputs().list);
  inputs().all.clear();
}

void note_input(const fs::path& path) {
  if (!inputs().kept) return;
  struct stat status {};
  std::error_code error;
  const fs::path resolved = fs::canonical(path, error);
  if (error || ::stat(path.c_str(), &status) != 0) return;
  const std::lock_guard<std::mutex> locked(inputs().list);
  for (const Input& input : inputs().all) {
    if (input.resolved == resolved && input.number == status.st_ino && input.device == status.st_dev) return;
  }
  inputs().all.push_back({status.st_dev, status.st_ino, path, resolved});
}

void refuse_input_as_output(const fs::path& path) {
  if (!inputs().kept) return;
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) return;
  std::error_code error;
  const fs::path resolved = fs::canonical(path, error);
  const std::lock_guard<std::mutex> locked(inputs().list);
  for (const Input& input : inputs().all) {
    if (input.device == status.st_dev && input.number == status.st_ino) {
      throw InputError({.file = path.string()}, "is an input of the command", "another name for the output");
    }
    if (S_ISDIR(status.st_mode) && !error && lies_in(input.resolved, resolved)) {
      throw InputError({.file = path.string()},
                       "would be replaced as a whole, and the input " + input.name.string() + " lies in it",
                       "another folder for the output");
    }
  }
}

}  // namespace abbe
