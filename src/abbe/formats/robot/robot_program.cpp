#include "abbe/formats/robot/robot_program.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "abbe/formats/robot/robot_scan.h"
#include "abbe/formats/text/ascii_letters.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/geometry/angle_units.h"

namespace abbe {
namespace {

/// Digits that 0.1 um at a reach of 1 m needs; Fanuc lists positions with three, and no more are documented.
std::size_t decimals_needed(RobotLanguage language, const RobotPosition& position, std::size_t number) {
  const bool is_length = position.kind == RobotPositionKind::pose
                             ? number < 3
                             : position.joints[number] && position.joints[number]->is_length;
  switch (language) {
    case RobotLanguage::rapid:
      return position.kind == RobotPositionKind::pose && number >= 3 ? 8 : is_length ? 4 : 6;
    case RobotLanguage::krl:
      return is_length ? 4 : 6;
    case RobotLanguage::fanuc_ls:
      return 3;
    case RobotLanguage::urscript:
      return is_length ? 7 : 8;
  }
  return 6;
}

struct RobotChange {
  RobotNumber number;
  std::string text;
};

/// Where a joint stands beyond the range of the configuration, by more than rounding.
bool is_beyond(const RobotPosition& position, std::size_t joint, double angle) {
  constexpr double kRounding = 1e-9;  // rad
  const auto& range = position.configuration[joint];
  return range && (angle < range->from - kRounding || angle > range->to + kRounding);
}

void change_configuration(const RobotProgram& program, const RobotPosition& position, const std::vector<double>& arm,
                          std::vector<RobotChange>& changes) {
  const auto& numbers = position.configuration_numbers;
  if (program.language == RobotLanguage::rapid) {
    constexpr std::size_t kQuadrantJoints[] = {0, 3, 5};
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      const double angle = arm[kQuadrantJoints[i]];
      if (is_beyond(position, kQuadrantJoints[i], angle))
        changes.push_back({numbers[i], fmt::format("{:.0f}", std::floor(angle / (90 * kDegree)))});
    }
  } else if (program.language == RobotLanguage::krl && !numbers.empty()) {
    const auto was = static_cast<unsigned long>(numbers[0].value);
    unsigned long bits = was;
    for (std::size_t i = 0; i < 6; ++i) {
      if (is_beyond(position, i, arm[i])) bits ^= 1UL << i;
    }
    if (bits == was) return;
    const std::string_view written = std::string_view(program.text).substr(numbers[0].begin, 2);
    changes.push_back({numbers[0], !written.starts_with('\'')      ? fmt::format("{}", bits)
                                   : upper_case(written[1]) == 'B' ? fmt::format("'B{:b}'", bits)
                                                                   : fmt::format("'H{:X}'", bits)});
  }
}

const RobotNumber& number_of(const RobotPosition& position, std::size_t number) {
  return position.kind == RobotPositionKind::pose ? position.pose[number] : *position.joints[number];
}

}  // namespace

const char* robot_language_name(RobotLanguage language) {
  switch (language) {
    case RobotLanguage::rapid:
      return "RAPID";
    case RobotLanguage::krl:
      return "KRL";
    case RobotLanguage::fanuc_ls:
      return "Fanuc LS";
    case RobotLanguage::urscript:
      return "URScript";
  }
  return "";
}

std::optional<RobotLanguage> robot_language_of(std::string_view file_name) {
  const std::size_t point = file_name.rfind('.');
  if (point == std::string_view::npos) return std::nullopt;
  std::string ending(file_name.substr(point));
  for (char& c : ending) c = lower_case(c);
  if (ending == ".mod" || ending == ".modx" || ending == ".sys" || ending == ".sysx") return RobotLanguage::rapid;
  if (ending == ".src" || ending == ".dat") return RobotLanguage::krl;
  if (ending == ".ls") return RobotLanguage::fanuc_ls;
  if (ending == ".script" || ending == ".urscript") return RobotLanguage::urscript;
  return std::nullopt;
}

RobotProgram parse_robot_program(std::string text, RobotLanguage language, const std::string& file) {
  RobotProgram program;
  program.language = language;
  program.file = file;
  program.text = std::move(text);
  switch (language) {
    case RobotLanguage::rapid:
      read_rapid(program);
      break;
    case RobotLanguage::krl:
      read_krl(program);
      break;
    case RobotLanguage::fanuc_ls:
      read_fanuc_ls(program);
      break;
    case RobotLanguage::urscript:
      read_urscript(program);
      break;
  }
  if (program.positions.empty()) {
    const bool others = !program.left.empty();
    throw InputError({file, others ? program.left.front().line : 0, 0, ""},
                     others ? program.left.front().reason + "; there is no other position" : "no position in this file",
                     fmt::format("a position of {} given in numbers", robot_language_name(language)));
  }
  return program;
}

double robot_joint_unit(RobotLanguage language, bool is_length) {
  return is_length ? 1.0 : language == RobotLanguage::urscript ? 1.0 : kDegree;
}

std::string robot_number_text(RobotLanguage language, const RobotPosition& position, std::size_t number, double value) {
  std::size_t decimals = decimals_needed(language, position, number);
  if (language != RobotLanguage::fanuc_ls)
    decimals = std::clamp<std::size_t>(number_of(position, number).decimals, decimals, 12);
  std::string text = fmt::format("{:.{}f}", value, decimals);
  // No sign before zero.
  if (text.starts_with('-') && text.find_first_not_of("-0.") == std::string::npos) text.erase(0, 1);
  return text;
}

std::string replaced_robot_text(const RobotProgram& program, const std::vector<RobotValues>& values,
                                const std::vector<std::vector<double>>& arms) {
  std::string text;
  std::size_t done = 0;
  std::vector<RobotChange> changes;
  for (std::size_t k = 0; k < program.positions.size(); ++k) {
    if (values[k].empty()) continue;
    const RobotPosition& position = program.positions[k];
    for (std::size_t i = 0; i < values[k].size(); ++i) {
      if (position.kind == RobotPositionKind::joints && !position.joints[i]) continue;
      const RobotNumber& number = number_of(position, i);
      std::string text_of_it = robot_number_text(program.language, position, i, values[k][i]);
      // What does not change in the digits that are written keeps its bytes.
      if (text_of_it == robot_number_text(program.language, position, i, number.value)) continue;
      changes.push_back({number, std::move(text_of_it)});
    }
    if (k < arms.size() && !arms[k].empty() && position.kind == RobotPositionKind::pose)
      change_configuration(program, position, arms[k], changes);
  }
  std::sort(changes.begin(), changes.end(),
            [](const RobotChange& a, const RobotChange& b) { return a.number.begin < b.number.begin; });
  for (const RobotChange& change : changes) {
    text.append(program.text, done, change.number.begin - done);
    text += change.text;
    done = change.number.begin + change.number.size;
  }
  text.append(program.text, done, std::string::npos);
  return text;
}

}  // namespace abbe
