#pragma once

// Internal to formats: states in a machine file.
#include <Eigen/Core>
#include <string>

#include "abbe/formats/text/toml_table.h"
#include "abbe/machine/machine.h"
#include "abbe/machine/machine_check.h"

namespace abbe {

/// Key gravity_m_per_s2 and the tables [state.NAME]; the axes of the machine are known. @throws InputError
void read_states(TomlTable& root, Machine& machine);

/// Throws InputError at the state that a problem of the machine is about.
[[noreturn]] void fail_state(TomlTable& root, const MachineProblem& problem);

/// The tables [state.NAME] of a machine, each with an empty line in front.
std::string states_text(const Machine& machine);

/// "[0, 0, -9.80665]"
std::string vector_text(const Eigen::Vector3d& v);

}  // namespace abbe
