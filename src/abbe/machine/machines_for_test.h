#pragma once

#include <cstddef>
#include <random>
#include <string>
#include <vector>

#include "abbe/machine/machine.h"

namespace abbe::test {

/// Machines of the examples folder and some that only tests need, built in code. See examples/machines for what the
/// dimensions mean.
Machine aguado_table();
Machine wang_grinder();
/// Yin's laser engraver; convention 'U': X and Y carry the table (text and Tables 2-3), 'P': printed equation (5).
Machine yin_engraver(char convention);
Machine liu_scanner();
Machine trunnion_mill();
Machine swivel_head_mill();
Machine head_table_mill();
Machine gantry_fork_head();
Machine lathe();
Machine three_axis_mill();
Machine moving_table_cmm();
Machine nutating_head_mill();
/// Eight axes: turntable, two parallel linear axes, fork head.
Machine redundant_gantry();
/// Three rotary axes in the head: full orientation.
Machine three_axis_head();
/// A bare rotary table in the machine's origin, turning in its own positive sense, from 0 to one turn.
Machine rotary_table();
Machine single_axis(const std::string& chain);

/// Jointed arms: six axes with a spherical wrist (ABB IRB 120), with three parallel axes (as a Universal Robots UR5),
/// seven axes (as a Kuka LBR iiwa).
Machine jointed_arm();
Machine parallel_axes_arm();
Machine seven_axis_arm();
/// An arm of rotary axes given by direction and point at zero; every travel +-180 degrees.
Machine arm_of_lines(const std::vector<Eigen::Vector3d>& directions, const std::vector<Eigen::Vector3d>& points,
                     const Eigen::Vector3d& tool);

/// The jointed arm with a parallelogram (B2 counts from the horizontal) and belts through its wrist.
Machine coupled_arm();
/// The seven-axis arm with a coupled elbow and a belt.
Machine coupled_seven_axis_arm();
/// The gantry with a fork head whose second axis is driven through the first one, and a Z that A lifts.
Machine coupled_fork_head();

struct NamedMachine {
  std::string name;
  Machine machine;
};
std::vector<NamedMachine> all_machines();

/// Commands evenly distributed over the travel (endless axes: two turns).
std::vector<double> random_commands(const Machine& machine, std::mt19937_64& generator);

}  // namespace abbe::test
