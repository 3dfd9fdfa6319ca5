#pragma once

#include <Eigen/Core>
#include <vector>

#include "abbe/identify/linkage/swing_head_linkage.h"
#include "reproduce_output.h"
#include "yin/study.h"

namespace abbe {

/// Commands of the five axes for one point of Table A4, convention U, C2 = 0.
struct YinAxisCommands {
  Eigen::Vector3d point;                ///< Table A4, workpiece frame, mm
  SwingHeadCommand positive, negative;  ///< both signs of A
  SwingHeadCommand printed;             ///< by equation (6) as printed, with the linkage in convention P
  double printed_beam_off = 0;          ///< between the beam that this gives in (5) and the one wanted, rad
};
/// @param positioning  with a position of the workpiece
std::vector<YinAxisCommands> yin_axis_commands(const YinPositioning& positioning);

/// The commands with A > 0, then the others, which only files and the page show.
std::vector<ReproducedTable> yin_command_tables(const std::vector<YinAxisCommands>& commands);

}  // namespace abbe
