#pragma once

#include <filesystem>

namespace abbe {

/// While one lives, files that are read are remembered, and writing over one of them is an InputError. For main():
/// whoever names the outputs of a command also names its inputs, and some of these only name each other (the covariance
/// beside an errors file, tables, programs called by programs). A file is known by what it is, not by its name: through
/// links, ./ and other folders. At most one at a time.
class KeptInputs {
 public:
  KeptInputs();
  ~KeptInputs();
  KeptInputs(const KeptInputs&) = delete;
  KeptInputs& operator=(const KeptInputs&) = delete;
};

/// For readers. Nothing happens outside the life of a KeptInputs.
void note_input(const std::filesystem::path& path);

/// For writers, and earlier for commands that compute for long before they write.
/// @throws InputError if `path` is a file that was read, or a folder in which one lies: folders of results are replaced
/// as a whole
void refuse_input_as_output(const std::filesystem::path& path);

}  // namespace abbe
