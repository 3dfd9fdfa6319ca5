#pragma once

namespace abbe {

class Subcommand;
struct CommandLine;

void add_compensate_command(CommandLine& line);
/// abbe compensate freeze: machine and errors to a file for real time.
void add_compensate_freeze(Subcommand& compensate, CommandLine& line);
/// abbe compensate gcode: programs whose actual tool follows the commanded path.
void add_compensate_gcode(Subcommand& compensate, CommandLine& line);
/// abbe compensate kinematics: rotary axes as a control with a transformation of five axes takes them.
void add_compensate_kinematics(Subcommand& compensate, CommandLine& line);
/// abbe compensate poses: corrected axis commands, pose by pose.
void add_compensate_poses(Subcommand& compensate, CommandLine& line);
/// abbe compensate table: tables of controls, and what they do not carry.
void add_compensate_table(Subcommand& compensate, CommandLine& line);

}  // namespace abbe
