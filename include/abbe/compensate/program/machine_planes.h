#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "abbe/compensate/program/plane_kinematics.h"
#include "abbe/compensate/program/word_axes.h"
#include "abbe/machine/inverse_kinematics.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// Tilted planes of a nominal machine with X, Y, Z and one or two rotary axes that words move.
///
/// Where several positions of the rotary axes lie within travel, the one at which the first rotary axis turns least is
/// taken; if equal, the second one turns least; if equal again, the first is nearest to zero, then the second. First is
/// the axis nearest to the bed; where one carries the tool and one the workpiece, that of the workpiece.
/// Source: FANUC Series 16i/18i operator's manual, tilted working plane command, "output judgement conditions".
class MachinePlanes final : public PlaneKinematics {
 public:
  /// Axes that no word moves rest at zero.
  MachinePlanes(const Machine& machine, const WordAxes& words);

  const std::string& problem() const override { return problem_; }
  void turn_with_workpiece(const WordValues& at_zero, const std::array<double, 3>& tool,
                           WordValues& words) const override;
  std::string turn_tool(ProgramCoordinates coordinates, const std::array<double, 3>& direction,
                        const WordValues& at_zero, WordValues& words) const override;

 private:
  /// Functional point of a tool in the workpiece frame, at words that are positions of the axes.
  Eigen::Vector3d point(const WordValues& words, const Eigen::Vector3d& tool) const;

  Machine machine_;
  WordKinematics kinematics_;
  InverseKinematics inverse_;
  std::vector<std::size_t> rotary_;  ///< axes that words move, in the order in which their turns count
  std::string problem_;
};

}  // namespace abbe
