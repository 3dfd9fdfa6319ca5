#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "abbe/formats/shapes/mesh_file.h"

namespace abbe {

class Option;
class Subcommand;

/// How a command reads the STEP files among its meshes: the options for that, the same for all commands.
class StepReading {
 public:
  /// Adds the options; this object has to live on.
  void add_to(Subcommand* command);

  /// read_mesh() by these options, with progress on a terminal. Faces that are left out are told.
  MeshFile read(const std::filesystem::path& mesh, std::optional<FileLength> unit = {}, int threads = 0) const;

  /// The same where nothing may be missing. @throws InputError also if faces are left out
  /// @param expected  for the message: all of what
  MeshFile read_whole(const std::filesystem::path& mesh, const std::string& expected) const;

  /// For options that were given in vain: those of no STEP file would have no effect.
  /// @param meshes  that the command reads, of which their contents count; an empty name is none
  /// @throws InputError, also if one of them cannot be read
  void require_step_among(const std::vector<std::filesystem::path>& meshes) const;

  /// @throws InputError if one of the options was given
  void refuse(const std::string& why) const;

 private:
  MeshFile read_with_progress(const std::filesystem::path& mesh, MeshFileOptions options) const;
  const Option* given() const;

  StepOptions options_;
  std::vector<const Option*> added_;
};

}  // namespace abbe
