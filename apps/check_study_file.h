#pragma once

#include <string>

namespace abbe {

/// Reads a study with its readings and says whether the nominal machine explains them. @throws InputError
int check_study_file(const std::string& file, bool json);

}  // namespace abbe
