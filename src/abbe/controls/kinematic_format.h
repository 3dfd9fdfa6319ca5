#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "abbe/controls/kinematic_values.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// What a control believes of a machine: nothing but nominal kinematics.
struct BelievedMachine {
  Machine machine;           ///< with the values of the control in it
  std::vector<double> zero;  ///< [axes] taken off the commands of rotary axes, rad
};

/// A number before it is written.
struct PlainValue {
  std::string name;
  ValueKind kind = ValueKind::length;
  double value = 0;
};

/// Numbers by their names as a reader finds them; mm, rad and components.
using NamedNumbers = std::map<std::string, double>;

/// A format of kinematic values: words and functions, in a file of its own.
struct KinematicFormat : KinematicFormatWords {
  std::string file_name;
  bool takes_tool_carrier = false;
  /// The values that state a geometry. @param nominal  for the chain; @throws InputError for one it does not have
  std::function<std::vector<PlainValue>(const BelievedMachine& nominal, const BelievedMachine& geometry,
                                        std::optional<int> tool_carrier)>
      values;
  /// The file. Writes `values` rounded.
  std::function<std::string(const BelievedMachine& nominal, const std::vector<KinematicValue>& values,
                            std::optional<int> tool_carrier)>
      text;
  std::function<NamedNumbers(const std::string& text)> read;
  /// What the control believes: the nominal machine with the numbers read.
  std::function<BelievedMachine(const BelievedMachine& nominal, const NamedNumbers& numbers,
                                std::optional<int> tool_carrier)>
      believed;
  std::function<std::vector<std::string>(const BelievedMachine& nominal)> settings;
};

KinematicFormat general_kinematic_values();
KinematicFormat linuxcnc_kinematic_values();
KinematicFormat siemens_kinematic_values();
KinematicFormat fanuc_kinematic_values();
KinematicFormat heidenhain_kinematic_values();

const std::vector<KinematicFormat>& all_kinematic_formats();

/// Names of the three components of a vector, with its values.
void add_vector(std::vector<PlainValue>& values, const std::vector<std::string>& names, ValueKind kind,
                const Eigen::Vector3d& vector);
/// The vector of three such numbers.
Eigen::Vector3d vector_of(const NamedNumbers& numbers, const std::vector<std::string>& names);

/// Numbers of lines "<before>NAME<between>VALUE"; other lines are left out.
NamedNumbers numbers_of_lines(const std::string& text, const std::string& before, const std::string& between);

/// A number with so many decimals, without a minus sign in front of zero.
std::string decimals(double value, int count);

}  // namespace abbe
