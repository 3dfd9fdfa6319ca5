#pragma once

#include <cstddef>
#include <vector>

#include "abbe/compensate/program/correction_step.h"

namespace abbe {

/// What ChordSteps keeps of a block of poses: rows of the inverse of the derivative, as the workpiece sees them.
struct ChordBlock {
  using Lanes = CorrectionBlock::Lanes;
  alignas(128) Lanes turn[2][3];  ///< times the rotation vector that is missing: turns of the turning axes
  Lanes lever[2][3];              ///< derivative of the point by the turning axes, mm per rad
  Lanes reach[3][3];              ///< times what is missing of the point then: shifts of the reaching axes
  Lanes left;                     ///< 1 where a pose is on its way, 0 where it is reached, -1 where steps do not serve
  Lanes missing;                  ///< in tolerances, before the last step
};

/// Steps of whole blocks to the wanted poses with one derivative, that of the nominal machine at the commands that
/// came.
///
/// It differs from the actual one by about the size of the errors (1e-4), so that each step gains nearly four digits,
/// for a small part of what the actual derivative costs (a chord method: Ortega and Rheinboldt 1970, 10.2.1). It serves
/// poses that are far from singularities and whose residuals become smaller by a factor at each step; all others are
/// left to CorrectionStep. As there, what is missing of a pose is evaluated with all errors.
class ChordSteps {
 public:
  /// @param turning   two rotary axes that take the direction of the tool, or none
  /// @param reaching  three linear axes that take the point
  ChordSteps(const Machine& machine, const CorrectionOptions& options, const std::vector<std::size_t>& turning,
             const std::vector<std::size_t>& reaching);

  /// Takes the derivative at the positions of the block, which has been evaluated there, and marks its active poses.
  void start(const CorrectionBlock& block, ChordBlock& chord) const;
  /// A step of all poses that are not reached; residuals of all.
  /// @returns whether positions have changed, so that the block has to be evaluated
  bool step(CorrectionBlock& block, ChordBlock& chord) const;

  struct Line {
    std::size_t axis = 0;
    bool rotary = false;
    int turning = -1, reaching = -1;  ///< which of them, or -1
    double sign = 1;                  ///< of the motion on the way from the workpiece to the tool
    double direction[3] = {};
    double point[3] = {};
  };
  /// As plain numbers, for the vectors.
  struct Numbers {
    std::vector<Line> lines;  ///< from the workpiece to the tool
    double rotation[9] = {};  ///< workpiece from bed with all axes at zero, row-major
    double offset[3] = {};    ///< mm
    bool turns = false;       ///< two axes take the direction
    bool oriented = false;    ///< the direction is wanted, and what is missing of it stated
    double largest_turn = 0, largest_shift = 0, position_tolerance = 0, orientation_tolerance = 0;
  };

 private:
  Numbers numbers_;
};

}  // namespace abbe
