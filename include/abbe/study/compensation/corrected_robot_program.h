#pragma once

// Positions of a robot program corrected for the errors of the robot, as `abbe compensate poses` does it:
//
//   #include <abbe/formats/files/text_file.h>
//   #include <abbe/formats/machine/machine_file.h>
//   #include <abbe/study/compensation/corrected_robot_program.h>
//
//   #include <cstdio>
//
//   int main() {
//     const char* file = "examples/robot/arm.mod";
//     abbe::RobotProgramRequest request;
//     request.machine = abbe::read_machine("examples/robot/arm.machine.toml");
//     request.errors = abbe::read_errors("examples/robot/arm.errors.toml", request.machine);
//     request.program = abbe::parse_robot_program(abbe::read_text_file(file), abbe::RobotLanguage::rapid, file);
//     const abbe::CorrectedRobotProgram result = abbe::correct_robot_program(request);
//     if (!result.refused.empty()) return 1;
//     std::printf("%zu positions corrected\n", result.positions.size());
//     return 0;  // result.text is the program
//   }
//
// It prints:
//
//   4 positions corrected
//
// What is read of a program and how it is corrected: docs/robot-programs.md.

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "abbe/compensate/corrected_poses.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/robot/robot_program.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// A robot program that is to be corrected. The names of the machine's axes end in the number of their joint.
///
/// Messages name a field by the option of `abbe compensate poses` that sets it, given below.
struct RobotProgramRequest {
  Machine machine;
  ErrorsFile errors;
  RobotProgram program;
  std::string machine_file;  ///< name for messages

  double largest_turn = kLargestTurnOfArm;  ///< --largest-turn-deg: of all axes together; at most 10 degrees
  std::vector<std::size_t> held;            ///< --hold: axes that keep their commands
  double leave_out_factor = 0;              ///< --leave-out-below-uncertainty: only 0, a program keeps all errors
  std::optional<double> limit_um;           ///< --limit-um: larger corrections of the point are refused; above zero
};

/// One position; lengths in mm, angles in rad.
struct CorrectedRobotPosition {
  std::vector<double> nominal;    ///< [axes] commands that the position means; empty: they are not known
  std::vector<double> corrected;  ///< [axes] commands that bring the actual tool there; empty: none do
  bool is_nearest = false;        ///< several sets of commands fit; those nearest to the position before were taken
  std::string problem;            ///< why it is not corrected, in words; empty: it is
  double shift = 0;               ///< of the functional point, actual less nominal, at `nominal`
  double position_left = 0;       ///< of the actual tool at the numbers as they are written
  double orientation_left = 0;
};

struct CorrectedRobotProgram {
  std::string text;  ///< the corrected program; every byte that is no number of a position is as it was
  std::vector<CorrectedRobotPosition> positions;  ///< as in RobotProgram::positions
  std::vector<UncorrectedPosition> left;          ///< as in RobotProgram::left
  std::string refused;                            ///< why the program must not be used, in words; empty: it may
  bool has_reversals = false;                     ///< the errors have reversal values, which are not in the program
};

/// The program with positions that bring the actual tool to where the nominal robot has it: joint positions as
/// commands, Cartesian ones as the poses that the control's own nominal kinematics turns into these commands. Opens no
/// file and prints nothing. A program with a position that cannot be corrected is refused as a whole.
/// @throws InputError for a machine or errors that do not fit the program, and for what is out of range in the request
CorrectedRobotProgram correct_robot_program(const RobotProgramRequest& request);

/// For people; complete lines. @param output  name of the file of the corrected program
std::string corrected_robot_text(const RobotProgramRequest& request, const CorrectedRobotProgram& result,
                                 const std::string& output, bool written);

/// The same for programs; units in the keys.
nlohmann::ordered_json corrected_robot_json(const RobotProgramRequest& request, const CorrectedRobotProgram& result,
                                            const std::string& output, bool written);

}  // namespace abbe
