#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "abbe/compensate/program/command_correction.h"
#include "abbe/errors/error_set.h"
#include "abbe/formats/controls/table_heidenhain_kinematics.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// An axis of the machine as the kinematics description of a HEIDENHAIN control has it.
///
/// The description goes from the tool to the table. A row moves the frame by its value, an axis by minus its command,
/// on either side of the bed: +X moves the tool by +X against the table, whatever of the two moves.
struct DescribedAxis {
  std::size_t axis = 0;                                         ///< index into Machine::axes
  char letter = 'X';                                            ///< MachAxis
  std::size_t coordinate = 0;                                   ///< kinematics_coordinate(letter)
  Eigen::Vector3d letter_direction = Eigen::Vector3d::UnitX();  ///< along (about) which MachAxis moves
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< of the frame in front of it, all axes at zero; mm, machine
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();   ///< from the origin before to this one
  std::size_t tilt_coordinate[2] = {0, 0};           ///< of the two turns in front of MachAxis, undone behind it
  double tilt[2] = {0, 0};                           ///< rad; they turn letter_direction to that of the axis

  /// Of the two turns.
  Eigen::Matrix3d tilted() const;
};

/// Sets the two turns, in the order of the rows, that take the unit vector of `described.coordinate` to a direction.
/// The turn about the axis itself would come last and change nothing. Manual, page 684: B0X, C0X in front of X.
void tilt_to(const Eigen::Vector3d& to, DescribedAxis& described);

/// All axes in the order of the description, with the location errors of the rotary ones in `origin` and of all in
/// `tilt`.
/// @param format  for messages: "heidenhain"
/// @throws InputError for a machine that the description does not have: two axes of one letter, other letters, a linear
///   axis that does not move the tool along +X, +Y or +Z of the workpiece as its letter says
std::vector<DescribedAxis> described_axes(const Machine& machine, const ErrorSet& errors, const std::string& format);

/// How an axis moves the frame of the description, without errors: about (along) its direction by minus its command.
/// 1, or -1 where the direction of the machine file is the other one.
double described_sense(const Axis& axis);

/// What a control does with a description and the tables that belong to it.
///
/// Own columns are added to the commands of their axes. The linear axes bring the functional point of the chain with
/// COMPTAB to where the nominal machine has it; every table is looked up at the command, before any correction. The
/// workpiece stands on the table frame as the chain without COMPTAB has it with all axes at zero.
class DescribedCorrection final : public CommandCorrection {
 public:
  DescribedCorrection(const Machine& machine, const std::vector<KinematicsRow>& rows,
                      std::vector<ComponentTable> tables);
  DescribedCorrection(const DescribedCorrection&) = delete;  // links_ point into tables_
  DescribedCorrection& operator=(const DescribedCorrection&) = delete;
  void evaluate(const PoseList& commands, PoseList& correction) const override;

 private:
  /// A row, or MachAxis.
  struct Link {
    std::size_t coordinate = 0;
    double value = 0;                  ///< mm or rad
    const AxisTable* table = nullptr;  ///< added to `value`
    std::size_t axis = Machine::npos;  ///< of MachAxis
  };
  struct Reached {
    Eigen::Vector3d point;       ///< functional point in the workpiece frame
    Eigen::Matrix3Xd by_linear;  ///< its movement by the linear axes
  };

  Reached reached(const std::vector<double>& pose) const;

  Machine machine_;
  std::vector<ComponentTable> tables_;
  std::vector<Link> links_;
  std::vector<std::size_t> linear_;  ///< axes, in the order of Reached::by_linear
  RigidTransform workpiece_from_end_;
};

}  // namespace abbe
