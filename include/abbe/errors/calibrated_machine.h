#pragma once

#include <string>
#include <vector>

#include "abbe/errors/error_set.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// A machine whose constant errors are part of its nominal geometry.
///
/// Location errors displace axis lines and the tool offset error the functional point, which is a change of the
/// machine's data and nothing else: with them in place the nominal kinematics is the actual one, exactly, and with it
/// every branch of the inverse. Zero position errors remain as offsets of the commands.
struct CalibratedMachine {
  Machine machine;           ///< travels are those of position = command + zero_position
  std::vector<double> zero;  ///< [axes] zero position errors, mm or rad: command = position - zero
  std::string variable;      ///< name of an error motion that depends on the position and is not contained; or empty
};

/// @throws std::invalid_argument for errors with states, which are not constant
CalibratedMachine calibrated_machine(const Machine& machine, const ErrorSet& errors);

}  // namespace abbe
