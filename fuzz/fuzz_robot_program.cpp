// Robot programs and Denavit-Hartenberg tables: any bytes give positions that lie in the text, or an InputError; the
// program with the same numbers, and with others, reads back.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include "abbe/formats/machine/dh_file.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/robot/robot_program.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/number_text.h"

namespace {

void check_dh(const std::string& text, const char* file) {
  abbe::DhArm arm;
  try {
    arm = abbe::parse_dh_arm(text, file);
  } catch (const abbe::InputError&) {
    return;
  }
  const abbe::Machine machine = abbe::parse_machine(abbe::dh_machine_text(arm, file), "written.machine.toml");
  const std::vector<double> zero(arm.joints.size(), 0.0);
  const abbe::RigidTransform wanted = abbe::dh_pose(arm, zero),
                             found = abbe::nominal_workpiece_from_tool(machine, zero);
  if (!((wanted.translation - found.translation).norm() <= 1e-9 * (1 + wanted.translation.norm()) + 1e-3)) std::abort();
}

void check_program(const std::string& text, abbe::RobotLanguage language) {
  abbe::RobotProgram program;
  try {
    program = abbe::parse_robot_program(text, language, "fuzz");
  } catch (const abbe::InputError&) {
    return;
  }
  if (program.positions.empty()) std::abort();
  std::vector<abbe::RobotValues> other;
  for (const abbe::RobotPosition& position : program.positions) {
    abbe::RobotValues values;
    const auto add = [&](const abbe::RobotNumber& number) {
      if (number.size == 0 || number.begin + number.size > text.size() || !std::isfinite(number.value)) std::abort();
      values.push_back(number.value);
    };
    if (position.line == 0) std::abort();
    if (position.kind == abbe::RobotPositionKind::pose) {
      if (position.pose.size() != (language == abbe::RobotLanguage::rapid ? 7 : 6)) std::abort();
      for (const abbe::RobotNumber& number : position.pose) add(number);
      const abbe::RigidTransform pose = abbe::robot_pose(program, position);
      values = abbe::robot_pose_numbers(language, position, pose);
    } else {
      for (const auto& number : position.joints) {
        if (number) {
          add(*number);
        } else {
          values.push_back(0);
        }
      }
    }
    // The nearest way to write an angle may be beyond what a reader takes.
    for (const double value : values) {
      if (std::abs(value) > 0.9 * abbe::kLargestInput) return;
    }
    other.push_back(values);
  }
  const std::string written = abbe::replaced_robot_text(program, other);
  const abbe::RobotProgram back = abbe::parse_robot_program(written, language, "written");
  if (back.positions.size() != program.positions.size() || back.left.size() != program.left.size()) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string text(reinterpret_cast<const char*>(data) + 1, size - 1);
  const unsigned kind = data[0] % 6;
  if (kind < 4) {
    check_program(text, static_cast<abbe::RobotLanguage>(kind));
  } else {
    check_dh(text, kind == 4 ? "fuzz.dh.toml" : "fuzz.csv");
  }
  return 0;
}
