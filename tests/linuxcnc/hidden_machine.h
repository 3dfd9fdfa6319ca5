#pragma once

// A machine with hidden errors, as LinuxCNC sees it through the module, and what the library says of it.
#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "abbe/compensate/compensated_inverse.h"
#include "abbe/errors/error_set.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// Which joint is which axis, and which word of a program it has: what linuxcnc/README.md says, written by hand.
struct Wiring {
  std::string machine;              ///< of examples/machines
  std::vector<std::string> joints;  ///< axes in the order of joints
  std::string words;                ///< of the world coordinates, in the same order: "XYZAC"
  bool tool_space = true;           ///< X Y Z are the tool's point; else every word is a nominal axis position
};

/// The errors of the machine are hidden: what is frozen are identified ones, every parameter drawn with the standard
/// uncertainty that is stated.
class HiddenMachine {
 public:
  explicit HiddenMachine(const Wiring& given);

  std::size_t count() const { return axis_of_joint.size(); }
  bool is_rotary(std::size_t joint) const;
  /// mm or rad of LinuxCNC's unit (mm, degree).
  double unit(std::size_t joint) const;
  /// Joints of LinuxCNC in chain order, mm and rad.
  std::vector<double> commands_of(const double* joints) const;
  /// @param offset  tool length offset as LinuxCNC adds it to the world, mm
  Machine with_tool(const Eigen::Vector3d& offset) const;
  /// World coordinates as LinuxCNC has them (mm, degrees; by joint), of nominal commands.
  std::vector<double> world_of(const std::vector<double>& commands, const Eigen::Vector3d& offset) const;

  Wiring wiring;
  Machine machine;  ///< without a tool
  Eigen::Vector3d tool_offset;
  ErrorSet truth, identified;
  Eigen::MatrixXd covariance;  ///< of the identified parameters, as stated
  std::vector<std::size_t> axis_of_joint;
  Eigen::Vector3d world_zero = Eigen::Vector3d::Zero();
};

/// What the library answers with a tool.
class Library {
 public:
  Library(const HiddenMachine& hidden, const Eigen::Vector3d& offset, const ErrorSet& errors);
  Library(const HiddenMachine& hidden, const Eigen::Vector3d& offset) : Library(hidden, offset, hidden.identified) {}

  /// Nominal commands (chain order; mm, rad) of a world position; empty if there are none.
  std::vector<double> nominal(const double* world) const;
  std::vector<double> compensated(const std::vector<double>& nominal, CorrectionStatus& status) const;
  /// Covariance of the tool point's correction, mm^2, from the uncertainty that is stated.
  Eigen::Matrix3d point_covariance(const std::vector<double>& nominal) const;
  /// How far the actual tool at `commands` is from where the nominal one is at `nominal`, mm.
  double error(const ErrorSet& actual, const std::vector<double>& commands, const std::vector<double>& nominal) const;

  const Machine& machine() const { return machine_; }

 private:
  const HiddenMachine& hidden_;
  Eigen::Vector3d offset_;
  Machine machine_;
  CompensatedInverse inverse_;
};

/// A frozen compensation in a file. @param uncertain  state the uncertainty
/// @returns the largest difference of the uncertainty in it from the full model's, mm
double write_frozen(const HiddenMachine& hidden, const std::string& path, bool uncertain);

}  // namespace abbe
