#pragma once

#include <string>

namespace abbe {

/// True for names of frozen compensations (*.abbec).
bool is_frozen_file(const std::string& file);

/// Says what a frozen compensation is for and what was found when it was made. @throws InputError for a file that a
/// controller would refuse
int check_frozen(const std::string& file, bool json);

}  // namespace abbe
