#include <fmt/format.h>

#include "abbe/formats/robot/robot_scan.h"

namespace abbe {
namespace {

/// True if six numbers in brackets begin here; the scan stays where it is.
bool is_ur_list(RobotScan& scan, const std::string& name) {
  const std::size_t begin = scan.at;
  bool is_list = scan.take('[');
  // What is not a number is an expression, which stays as it is: d2r(90), q[0] + 0.1.
  for (std::size_t i = 0; is_list && !scan.at_end() && scan.peek() != ']'; ++i) {
    if (i > 0 && !scan.take(',')) is_list = false;
    if (!is_list || !scan.is_number()) {
      is_list = false;
      break;
    }
    scan.number(name, "a number");
    const char next = scan.peek();
    is_list = next == ',' || next == ']';
  }
  scan.at = begin;
  return is_list;
}

/// Reads a position at the place of an argument, or lists it as one that is not corrected.
void read_ur_position(RobotProgram& program, RobotScan& scan, const std::string& name) {
  scan.peek();
  const std::size_t begin = scan.at;
  const std::size_t line = scan.line_of(begin);
  const std::string_view word = scan.word();
  const bool is_pose = word == "p" && scan.peek() == '[';
  if (!(is_pose || word.empty()) || !is_ur_list(scan, name)) {
    program.left.push_back({line, fmt::format("{}: the position is not given in numbers", name)});
    return;
  }
  RobotPosition position;
  position.kind = is_pose ? RobotPositionKind::pose : RobotPositionKind::joints;
  position.name = name;
  position.line = line;
  const std::string expected = is_pose ? "p[x, y, z, rx, ry, rz] in m and rad" : "[six joint angles] in rad";
  scan.expect('[', name, expected);
  for (std::size_t i = 0; i < 6; ++i) {
    if (i > 0) scan.expect(',', name, expected);
    const RobotNumber number = scan.number(name, expected);
    if (is_pose) {
      position.pose.push_back(number);
    } else {
      position.joints[i] = number;
    }
  }
  scan.expect(']', name, expected);
  program.positions.push_back(std::move(position));
}

}  // namespace

void read_urscript(RobotProgram& program) {
  RobotScan scan(program.text, program.file, '#');
  std::string_view before;
  for (std::string_view word = scan.next_word(); !word.empty(); before = word, word = scan.next_word()) {
    const bool one = word == "movej" || word == "movel" || word == "movep", two = word == "movec";
    if ((!one && !two) || before == "def" || !scan.take('(')) continue;
    const std::string name(word);
    read_ur_position(program, scan, name);
    // The second position of an arc, if the first one is in numbers too.
    if (two && scan.take(',')) read_ur_position(program, scan, name);
  }
}

}  // namespace abbe
