#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace abbe {

/// Numbers with commas between them: "12,30.5". An empty text has none.
/// @param field     for messages: "--fixed-radius-mm"
/// @param expected  in words, for messages
/// @throws InputError for a part that is no number
std::vector<double> parse_number_list(const std::string& text, const std::string& field, const std::string& expected);

/// A direction of any length: "0,0,1". @throws InputError for other than three numbers
Eigen::Vector3d parse_direction(const std::string& text, const std::string& field);

}  // namespace abbe
