#include <fmt/format.h>

#include "abbe/formats/robot/robot_scan.h"
#include "abbe/formats/text/ascii_letters.h"

namespace abbe {
namespace {

constexpr std::array<std::string_view, 6> kLsPoseParts = {"X", "Y", "Z", "W", "P", "R"};

/// J1 to J9, E1 to E3 as an index among the joints; J7 is the first additional axis as E1 is.
std::optional<std::size_t> ls_joint(std::string_view part) {
  if (part.size() != 2 || !is_digit(part[1]) || part[1] == '0') return std::nullopt;
  const std::size_t number = static_cast<std::size_t>(part[1] - '1');
  if (part[0] == 'J') return number;
  if (part[0] == 'E' && number < 6) return 6 + number;
  return std::nullopt;
}

/// The text between blanks up to a comma, a brace or the end of the line, as of UF and UT.
std::string ls_setting(RobotScan& scan) {
  scan.peek();
  const std::size_t begin = scan.at;
  while (!scan.at_end() && std::string_view(",}\r\n").find(scan.code()[scan.at]) == std::string_view::npos) ++scan.at;
  std::string text(scan.code().substr(begin, scan.at - begin));
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.pop_back();
  return text;
}

/// Reads what stands behind "GP1:" up to the next group or the end of the position.
RobotPosition ls_group(RobotScan& scan, const std::string& name, bool& in_numbers) {
  RobotPosition position;
  position.name = name;
  std::array<std::optional<RobotNumber>, 6> pose{};
  std::size_t of_pose = 0, of_joints = 0;
  while (!scan.at_end() && scan.peek() != '}') {
    const std::size_t at = scan.at;
    const std::string part(scan.word());
    if (part.size() > 2 && part.starts_with("GP") && scan.peek() == ':') {
      scan.at = at;
      break;
    }
    const std::string field = name + "." + part;
    if (part.empty()) scan.fail(at, name, "no name of a value here", "X, Y, Z, W, P, R, J1, ..., UF, UT or CONFIG");
    if (scan.take(':')) {
      if (part == "CONFIG") {
        scan.expect('\'', field, "the configuration in quotes");
        const std::size_t end = scan.code().find('\'', scan.at);
        if (end == std::string_view::npos) scan.fail(scan.at, field, "has no end", "a quote behind it");
        scan.at = end + 1;
      } else {
        const std::string value = ls_setting(scan);
        if (part == "UF" || part == "UT")
          position.frame += fmt::format("{}{} {}", part == "UT" ? ", " : "", part, value);
      }
    } else {
      scan.expect('=', field, "a value");
      if (scan.peek() == '*') {
        in_numbers = false;
        ls_setting(scan);
      } else {
        RobotNumber number = scan.number(field, "a number with mm or deg behind it");
        const std::string_view unit = scan.word();
        if (unit != "mm" && unit != "deg") scan.fail(scan.at - unit.size(), field, "has no unit", "mm or deg");
        number.is_length = unit == "mm";
        const auto joint = ls_joint(part);
        bool known = joint.has_value();
        if (joint) {
          if (position.joints[*joint]) scan.fail(number.begin, field, "is given twice", "each value once");
          position.joints[*joint] = number;
          of_joints += *joint < 6 ? 1 : 0;
        }
        for (std::size_t i = 0; i < 6; ++i) {
          if (part != kLsPoseParts[i]) continue;
          if (pose[i]) scan.fail(number.begin, field, "is given twice", "each value once");
          if (number.is_length != (i < 3)) scan.fail(number.begin, field, "has the wrong unit", i < 3 ? "mm" : "deg");
          pose[i] = number;
          ++of_pose;
          known = true;
        }
        if (!known) scan.fail(number.begin, field, "is not known", "X, Y, Z, W, P, R, J1 to J9 or E1 to E6");
      }
    }
    scan.take(',');
  }
  position.kind = of_pose > 0 ? RobotPositionKind::pose : RobotPositionKind::joints;
  if (in_numbers && (of_pose > 0 ? of_pose != 6 || of_joints > 0 : of_joints == 0)) {
    scan.fail(scan.at, name, "is not whole", "X, Y, Z, W, P and R, or J1 and what follows it");
  }
  if (in_numbers && of_pose > 0) {
    for (const auto& number : pose) position.pose.push_back(*number);
  }
  return position;
}

}  // namespace

void read_fanuc_ls(RobotProgram& program) {
  const std::string& text = program.text;
  std::size_t begin = text.starts_with("/POS") ? 0 : text.find("\n/POS");
  if (begin == std::string::npos) return;
  begin = text.find('\n', begin + 1);
  if (begin == std::string::npos) return;
  // Names of positions stand in double quotes.
  RobotScan scan(text, program.file, 0);
  scan.at = begin;
  while (scan.peek() != '/' && !scan.at_end()) {
    const std::size_t at = scan.at;
    if (scan.word() != "P") scan.fail(at, "/POS", "no position here", "P[1]{ ... }; or /END");
    scan.expect('[', "P", "the number of the position");
    const std::string number(scan.word());
    const std::string name = "P[" + number + "]";
    if (number.empty()) scan.fail(scan.at, "P", "has no number", "P[1]");
    if (scan.take(':')) scan.peek();
    scan.expect(']', name, "the end of its number");
    const std::size_t line = scan.line_of(scan.at);
    scan.expect('{', name, "the values of the position");
    for (bool first = true; scan.peek() != '}' && !scan.at_end(); first = false) {
      const std::size_t group_at = scan.at;
      const std::string group(scan.word());
      if (group.size() < 3 || !group.starts_with("GP")) scan.fail(group_at, name, "no group here", "GP1:");
      scan.expect(':', name, "a colon behind the group");
      bool in_numbers = true;
      RobotPosition position = ls_group(scan, name, in_numbers);
      position.line = line;
      if (group == "GP1" && first && in_numbers) {
        program.positions.push_back(std::move(position));
      } else {
        program.left.push_back(
            {scan.line_of(group_at),
             fmt::format("{}: {} {}", name, group, in_numbers ? "is not of the arm" : "has no numbers")});
      }
    }
    scan.expect('}', name, "the end of the position");
    scan.take(';');
  }
}

}  // namespace abbe
