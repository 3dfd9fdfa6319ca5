#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "abbe/controls/kinematic_values.h"
#include "abbe/machine/machine.h"
#include "abbe/report/evaluations/partial_errors.h"

namespace abbe {

/// What `abbe compensate kinematics` says of values; valid as long as what it refers to.
struct KinematicValuesReport {
  const Machine& machine;
  const KinematicValues& made;
  PartialErrors partial;             ///< what the errors file does not state
  std::vector<std::string> written;  ///< names of files
};

/// For people; complete lines.
std::string kinematic_values_text(const KinematicValuesReport& report);

/// For programs; units in the keys.
nlohmann::ordered_json kinematic_values_json(const KinematicValuesReport& report);

}  // namespace abbe
