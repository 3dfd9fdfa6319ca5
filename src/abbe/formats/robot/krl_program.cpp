#include <fmt/format.h>

#include <cmath>
#include <map>
#include <set>

#include "abbe/formats/robot/robot_scan.h"
#include "abbe/formats/text/ascii_letters.h"
#include "abbe/geometry/angle_units.h"

namespace abbe {
namespace {

constexpr std::array<std::string_view, 6> kPoseParts = {"X", "Y", "Z", "A", "B", "C"};

std::string krl_capitals(std::string_view word) {
  std::string text(word);
  for (char& c : text) c = upper_case(c);
  return text;
}

bool is_krl_position_type(const std::string& word) {
  return word == "E6POS" || word == "POS" || word == "E6AXIS" || word == "AXIS";
}

/// A1 to A6 and E1 to E6 as an index among the joints.
std::optional<std::size_t> krl_joint(const std::string& part) {
  if (part.size() != 2 || part[1] < '1' || part[1] > '6') return std::nullopt;
  if (part[0] == 'A') return static_cast<std::size_t>(part[1] - '1');
  if (part[0] == 'E') return static_cast<std::size_t>(part[1] - '1') + 6;
  return std::nullopt;
}

/// The bits of T: bit n - 1 is set where the angle of An is below zero.
void state_turn(RobotPosition& position, long bits) {
  for (std::size_t i = 0; i < 6; ++i) {
    const bool negative = (bits >> i & 1) != 0;
    position.configuration[i] = negative ? JointRange{-kTurn, 0} : JointRange{0, kTurn};
  }
}

/// The value of T: 35 or 'B100011' or 'H23'.
long krl_integer(RobotScan& scan, const std::string& field) {
  const std::string expected = "a whole number, 'B...' or 'H...'";
  if (!scan.take('\'')) {
    const std::size_t at = scan.at;
    const double value = scan.number(field, expected).value;
    if (value != std::floor(value) || value < 0 || value > 1e6) scan.fail(at, field, "is no whole number", expected);
    return static_cast<long>(value);
  }
  const std::size_t at = scan.at;
  const std::string digits = krl_capitals(scan.word());
  const int base = digits.starts_with('B') ? 2 : digits.starts_with('H') ? 16 : 0;
  long value = 0;
  bool sound = base != 0 && digits.size() > 1 && digits.size() < 12;
  for (std::size_t i = 1; sound && i < digits.size(); ++i) {
    const char c = digits[i];
    const int digit = is_digit(c) ? c - '0' : c >= 'A' && c <= 'F' ? c - 'A' + 10 : 99;
    sound = digit < base;
    value = value * base + digit;
  }
  if (!sound) scan.fail(at, field, "is no number", expected);
  scan.expect('\'', field, "the end of the number");
  return value;
}

/// Reads {X 1,Y 2,...} or {E6POS: X 1,...}, or says why it is not a whole position.
void read_krl_aggregate(RobotProgram& program, RobotScan& scan, const std::string& name) {
  RobotPosition position;
  position.name = name;
  scan.expect('{', name, "a position {X ..., Y ..., ...} or {A1 ..., ...}");
  position.line = scan.line_of(scan.at);
  std::map<std::string, RobotNumber> parts;
  std::optional<long> turn;
  bool in_numbers = true;
  do {
    std::string part = krl_capitals(scan.word());
    if (scan.take(':')) part = krl_capitals(scan.word());
    const std::string field = name + "." + part;
    if (part == "T" && !turn && scan.peek() != '}') {
      const std::size_t begin = scan.at;
      turn = krl_integer(scan, field);
      position.configuration_numbers = {{.begin = begin, .size = scan.at - begin, .value = static_cast<double>(*turn)}};
    } else if (part == "S" && scan.peek() != '}') {
      krl_integer(scan, field);
    } else if (scan.is_number()) {
      const bool is_angle = part.size() == 1 ? part >= "A" && part <= "C" : true;
      const RobotNumber number = scan.number(field, is_angle ? "degrees" : "mm");
      if (!parts.emplace(part, number).second) scan.fail(number.begin, field, "is given twice", "each part once");
    } else {
      in_numbers = false;
      while (scan.peek() != ',' && scan.peek() != '}' && !scan.at_end()) ++scan.at;
    }
  } while (scan.take(','));
  scan.expect('}', name, "the end of the position");

  const auto given = [&](const auto& wanted) {
    std::size_t count = 0;
    for (const auto& part : wanted) count += parts.count(std::string(part));
    return count;
  };
  constexpr std::array<std::string_view, 6> kJointParts = {"A1", "A2", "A3", "A4", "A5", "A6"};
  const std::size_t of_pose = given(kPoseParts), of_joints = given(kJointParts);
  if (!in_numbers || (of_pose != 6 && of_joints != 6) || (of_pose > 0 && of_joints > 0)) {
    program.left.push_back({position.line, fmt::format("{} is not given in full and in numbers", name)});
    return;
  }
  position.kind = of_pose == 6 ? RobotPositionKind::pose : RobotPositionKind::joints;
  if (position.kind == RobotPositionKind::pose) {
    for (const std::string_view part : kPoseParts) position.pose.push_back(parts.at(std::string(part)));
    if (turn) state_turn(position, *turn);
  }
  for (const auto& [part, number] : parts) {
    if (const auto joint = krl_joint(part)) position.joints[*joint] = number;
  }
  program.positions.push_back(std::move(position));
}

/// TOOL_NO and BASE_NO of {TOOL_NO 1,BASE_NO 0,...}: frames that positions are in.
void read_krl_frames(RobotScan& scan, std::set<std::string>& frames) {
  std::string frame;
  while (scan.peek() != '}' && !scan.at_end() && scan.code()[scan.at] != '\n') {
    const std::string part = krl_capitals(scan.word());
    if ((part == "TOOL_NO" || part == "BASE_NO") && scan.is_number()) {
      frame += fmt::format("{} {:g} ", part, scan.number(part, "a number").value);
    } else if (part.empty()) {
      ++scan.at;
    }
  }
  if (!frame.empty()) frames.insert(frame.substr(0, frame.size() - 1));
}

/// Goes behind "[3]" of an element; its text is added to the name.
void take_krl_index(RobotScan& scan, std::string& name) {
  if (scan.peek() != '[') return;
  const std::size_t begin = scan.at;
  while (!scan.at_end() && scan.code()[scan.at] != ']' && scan.code()[scan.at] != '\n') ++scan.at;
  if (scan.take(']')) name += scan.code().substr(begin, scan.at - begin);
}

}  // namespace

void read_krl(RobotProgram& program) {
  RobotScan scan(program.text, program.file, ';');
  std::set<std::string> declared, frames;
  bool of_position = false, of_frames = false;
  for (std::string_view word = scan.next_word(); !word.empty(); word = scan.next_word()) {
    const std::string name = krl_capitals(word);
    if (is_krl_position_type(name)) {
      of_position = true;
      continue;
    }
    if (name == "FDAT") {
      of_frames = true;
      continue;
    }
    const bool moves =
        name == "PTP" || name == "LIN" || name == "CIRC" || name == "SPTP" || name == "SLIN" || name == "SCIRC";
    std::string shown(word);
    if (moves && scan.peek() == '{') {
      do {
        read_krl_aggregate(program, scan, shown);
      } while (scan.take(',') && scan.peek() == '{');
    } else if (!moves) {
      take_krl_index(scan, shown);
      if (of_position) declared.insert(name);
      if (scan.take('=') && scan.peek() == '{') {
        const std::size_t line = scan.line_of(scan.at);
        if (of_frames) {
          read_krl_frames(scan, frames);
        } else if (declared.count(name) > 0) {
          read_krl_aggregate(program, scan, shown);
        } else if (!name.starts_with('$') && !of_position) {
          // Of any type: only what looks like a position is listed.
          const std::size_t begin = scan.at;
          const std::size_t end = std::min(scan.code().find('}', begin), scan.code().find('\n', begin));
          const std::string inside = krl_capitals(scan.code().substr(begin, end - begin));
          if (inside.starts_with("{X ") || inside.starts_with("{A1 "))
            program.left.push_back({line, fmt::format("{} is not declared as a position in this file", shown)});
        }
      }
    }
    of_position = of_position && scan.peek() == ',';
    of_frames = false;
  }
  if (frames.size() > 1) {
    for (RobotPosition& position : program.positions) {
      if (position.kind == RobotPositionKind::pose) position.frame = fmt::format("{}", fmt::join(frames, ", "));
    }
  }
}

}  // namespace abbe
