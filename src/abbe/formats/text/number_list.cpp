#include "abbe/formats/text/number_list.h"

#include <fmt/format.h>

#include <sstream>

#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/number_text.h"

namespace abbe {

std::vector<double> parse_number_list(const std::string& text, const std::string& field, const std::string& expected) {
  std::vector<double> values;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, ',');) {
    values.push_back(0);
    if (parse_number(part, 0, values.back()) != NumberProblem::none) {
      throw InputError({.field = field}, fmt::format("'{}' is not a number", part.substr(0, 40)), expected);
    }
  }
  return values;
}

Eigen::Vector3d parse_direction(const std::string& text, const std::string& field) {
  const char* const expected = "three numbers, not all zero: 0,0,1";
  const std::vector<double> d = parse_number_list(text, field, expected);
  if (d.size() != 3) {
    throw InputError({.field = field}, fmt::format("'{}' is not a direction", text.substr(0, 60)), expected);
  }
  return {d[0], d[1], d[2]};
}

}  // namespace abbe
