#pragma once

#include <filesystem>
#include <string_view>

#include "abbe/formats/shapes/mesh_file.h"

namespace abbe {

/// True if the contents begin like a STEP file (ISO 10303-21).
bool is_step(std::string_view contents);

/// The same for a file. @throws InputError if it cannot be read
bool is_step_file(const std::filesystem::path& path);

/// Where abbe-step is: the value of the environment variable ABBE_STEP_PROGRAM where that is set, else beside the
/// running program; empty if there is none: it was not built, perhaps because OpenCASCADE is missing.
/// @throws InputError if the variable names what is no program
std::filesystem::path step_program();

/// Reads the faces of a STEP file as triangles; see read_mesh() and docs/geometry-files.md.
///
/// OpenCASCADE does it, in a process of its own (abbe-step): a damaged file that makes it stop, run longer than
/// StepOptions::most_seconds (by a tenth and a second at most) or take more than 8 GiB is an InputError here. Nothing
/// is left on the disk, and the process ends with this one.
/// @throws InputError, also where abbe-step is missing
MeshFile read_step(const std::filesystem::path& path, const MeshFileOptions& options = {});

}  // namespace abbe
