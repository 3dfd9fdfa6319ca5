#pragma once

#include <string>

namespace abbe {

/// Whether a file is a study, by its name or its contents.
bool is_study_file(const std::string& file);

/// Of a file that is no study, shape or frozen compensation, whether it looks like a machine file.
/// @throws InputError if not, with what takes a file of its kind; and for a file that cannot be read
void require_machine_file(const std::string& file);

}  // namespace abbe
