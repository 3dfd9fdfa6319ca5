#pragma once

#include <string>

namespace abbe {

// What kind of file `abbe check` is given; of standard input (standard_input.h) the contents tell.

/// Whether a file is a point cloud or a mesh, by its name.
bool is_geometry_file(const std::string& file);

/// Of a point cloud or a mesh, whether it holds points only: by its name, and a PLY file without faces. An OBJ file
/// counts as a mesh. @throws InputError for a PLY file that cannot be read
bool has_points_only(const std::string& file);

/// Whether a file is a frozen compensation (*.abbec), by its name.
bool is_frozen_file(const std::string& file);

/// Whether a file is a study, by its name or its contents.
bool is_study_file(const std::string& file);

/// Of a file that is no study, shape or frozen compensation, whether it looks like a machine file.
/// @throws InputError if not, with what takes a file of its kind; and for a file that cannot be read
void require_machine_file(const std::string& file);

}  // namespace abbe
