#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace abbe {

/// While one lives, a file that exists is not replaced by an output until replace_existing_outputs() is called: writers
/// throw InputError instead. For main(): it is the one rule of all commands, whose option --force calls that. Without
/// one, writers replace, as programs that link this library expect. Folders of results that abbe wrote are not files;
/// their own rule is in results_folder.h. At most one at a time.
class KeptOutputs {
 public:
  KeptOutputs();
  ~KeptOutputs();
  KeptOutputs(const KeptOutputs&) = delete;
  KeptOutputs& operator=(const KeptOutputs&) = delete;
};

/// From now on outputs replace files that exist.
void replace_existing_outputs();

/// Whether files that exist stay.
bool existing_outputs_stay();

/// For commands before they begin to compute; writers check again when the file is finished.
/// @throws InputError if a file or a link has this name and is to stay
void refuse_existing_output(const std::filesystem::path& name);

/// For writers: an output is in its place, whole. Nothing happens outside the life of a KeptOutputs.
void note_complete_output(const std::filesystem::path& name);

/// Outputs that were noted since the last KeptOutputs began, by the names they were given, in their order: what to tell
/// the user if something fails later, or if the process is interrupted while it ends.
std::vector<std::string> complete_outputs();

/// For commands before they begin to compute: refuse_existing_output(), and what else is wrong with the name of a file
/// to write: that of a folder or a device, or one in a folder that does not exist or may not be written to.
/// @throws InputError
void check_output_file(const std::filesystem::path& name);

}  // namespace abbe
