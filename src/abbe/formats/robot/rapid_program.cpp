#include <fmt/format.h>

#include <cmath>

#include "abbe/formats/robot/robot_scan.h"
#include "abbe/geometry/angle_units.h"

namespace abbe {
namespace {

constexpr double kNoRapidAxis = 9e9;  // "9E9 is defined for axes which are not connected"

/// Reads [a, b, ...] of numbers.
std::vector<RobotNumber> rapid_numbers(RobotScan& scan, const std::string& field, std::size_t count,
                                       const std::string& expected) {
  std::vector<RobotNumber> numbers;
  scan.expect('[', field, expected);
  for (std::size_t i = 0; i < count; ++i) {
    if (i > 0) scan.expect(',', field, expected);
    numbers.push_back(scan.number(field, expected));
  }
  scan.expect(']', field, expected);
  return numbers;
}

void take_rapid_joints(RobotPosition& position, const std::vector<RobotNumber>& numbers, std::size_t first) {
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (numbers[i].value != kNoRapidAxis) position.joints[first + i] = numbers[i];
  }
}

RobotPosition rapid_aggregate(RobotScan& scan, RobotPositionKind kind, const std::string& name) {
  RobotPosition position;
  position.kind = kind;
  position.name = name;
  scan.peek();
  position.line = scan.line_of(scan.at);
  scan.expect(
      '[', name,
      kind == RobotPositionKind::pose ? "a robtarget [trans, rot, robconf, extax]" : "a jointtarget [robax, extax]");
  if (kind == RobotPositionKind::joints) {
    take_rapid_joints(position, rapid_numbers(scan, name + ".robax", 6, "[rax_1 ... rax_6] in degrees"), 0);
  } else {
    position.pose = rapid_numbers(scan, name + ".trans", 3, "[x, y, z] in mm");
    scan.expect(',', name, "rot after trans");
    const std::size_t at = scan.at;
    const std::vector<RobotNumber> rot = rapid_numbers(scan, name + ".rot", 4, "the quaternion [q1, q2, q3, q4]");
    double square = 0;
    for (const RobotNumber& q : rot) square += q.value * q.value;
    if (!(std::abs(std::sqrt(square) - 1) < 1e-3)) {
      scan.fail(at, name + ".rot", fmt::format("the quaternion has the length {:g}", std::sqrt(square)),
                "the length 1");
    }
    position.pose.insert(position.pose.end(), rot.begin(), rot.end());
    scan.expect(',', name, "robconf after rot");
    const std::vector<RobotNumber> quadrant = rapid_numbers(scan, name + ".robconf", 4, "[cf1, cf4, cf6, cfx]");
    constexpr std::size_t kJoint[] = {0, 3, 5};
    for (std::size_t i = 0; i < 3; ++i) {
      const double from = quadrant[i].value * 90 * kDegree;
      position.configuration[kJoint[i]] = JointRange{from, from + 90 * kDegree};
      position.configuration_numbers.push_back(quadrant[i]);
    }
  }
  scan.expect(',', name, "extax");
  take_rapid_joints(position, rapid_numbers(scan, name + ".extax", 6, "[eax_a ... eax_f]"), 6);
  scan.expect(']', name, "the end of the position");
  return position;
}

/// Elements of an array of any depth: [a, b] or [[a, b], [c, d]].
void read_rapid_elements(RobotProgram& program, RobotScan& scan, RobotPositionKind kind, const std::string& name,
                         std::size_t depth) {
  if (depth == 0) {
    program.positions.push_back(rapid_aggregate(scan, kind, name));
    return;
  }
  scan.expect('[', name, "the elements of an array in brackets");
  std::size_t index = 0;
  do {
    read_rapid_elements(program, scan, kind, fmt::format("{}{{{}}}", name, ++index), depth - 1);
  } while (scan.take(','));
  scan.expect(']', name, "the end of the array");
}

void read_rapid_data(RobotProgram& program, RobotScan& scan, RobotPositionKind kind) {
  const std::string name(scan.word());
  if (name.empty()) return;
  std::size_t depth = 0;
  if (scan.take('{')) {
    depth = 1;
    while (scan.peek() != '}' && scan.peek() != ';' && !scan.at_end()) depth += scan.code()[scan.at++] == ',' ? 1 : 0;
    scan.expect('}', name, "the size of the array in braces");
    if (depth > 3) scan.fail(scan.at, name, fmt::format("an array of {} dimensions", depth), "at most 3");
  }
  if (!scan.take(':')) return;
  scan.expect('=', name, "a value");
  if (scan.peek() != '[') {
    program.left.push_back({scan.line_of(scan.at), fmt::format("{} is not given in numbers", name)});
    return;
  }
  read_rapid_elements(program, scan, kind, name, depth);
  scan.expect(';', name, "the end of the declaration");
}

}  // namespace

void read_rapid(RobotProgram& program) {
  RobotScan scan(program.text, program.file, '!');
  bool declared = false;
  for (std::string_view word = scan.next_word(); !word.empty(); word = scan.next_word()) {
    if (declared && same_robot_word(word, "robtarget")) {
      read_rapid_data(program, scan, RobotPositionKind::pose);
    } else if (declared && same_robot_word(word, "jointtarget")) {
      read_rapid_data(program, scan, RobotPositionKind::joints);
    } else if (word.size() > 4 && same_robot_word(word.substr(0, 4), "Move") && scan.peek() != '(') {
      const std::string_view rest = scan.code().substr(scan.at);
      if (rest.substr(0, rest.find(';')).find('[') != std::string_view::npos) {
        program.left.push_back(
            {scan.line_of(scan.at), std::string(word) + " with a position, a speed or a zone in brackets"});
      }
    }
    declared = same_robot_word(word, "CONST") || same_robot_word(word, "PERS") || same_robot_word(word, "VAR");
  }
}

}  // namespace abbe
