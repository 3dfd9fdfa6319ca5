#include "abbe/controls/kinematic_format.h"

#include <fmt/format.h>

#include <charconv>
#include <sstream>

namespace abbe {

const std::vector<KinematicFormat>& all_kinematic_formats() {
  static const std::vector<KinematicFormat> formats = {general_kinematic_values(), linuxcnc_kinematic_values(),
                                                       siemens_kinematic_values(), fanuc_kinematic_values(),
                                                       heidenhain_kinematic_values()};
  return formats;
}

std::vector<KinematicFormatWords> kinematic_formats() {
  return {all_kinematic_formats().begin(), all_kinematic_formats().end()};
}

void add_vector(std::vector<PlainValue>& values, const std::vector<std::string>& names, ValueKind kind,
                const Eigen::Vector3d& vector) {
  for (std::size_t k = 0; k < 3; ++k) values.push_back({names[k], kind, vector[static_cast<Eigen::Index>(k)]});
}

Eigen::Vector3d vector_of(const NamedNumbers& numbers, const std::vector<std::string>& names) {
  return {numbers.at(names[0]), numbers.at(names[1]), numbers.at(names[2])};
}

NamedNumbers numbers_of_lines(const std::string& text, const std::string& before, const std::string& between) {
  NamedNumbers numbers;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with(before)) continue;
    const std::size_t end = line.find(between, before.size());
    if (end == std::string::npos) continue;
    double value = 0;
    const char* const number = line.data() + end + between.size();
    // Independent of the locale of the program that calls.
    if (std::from_chars(number, line.data() + line.size(), value).ec != std::errc()) continue;
    numbers[line.substr(before.size(), end - before.size())] = value;
  }
  return numbers;
}

std::string decimals(double value, int count) {
  std::string text = fmt::format("{:.{}f}", value, count);
  if (text.find_first_not_of("-0.") == std::string::npos && text.front() == '-') text.erase(0, 1);
  return text;
}

}  // namespace abbe
