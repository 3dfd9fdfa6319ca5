#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "abbe/compensate/axis_directions.h"
#include "abbe/compensate/compensated_inverse.h"
#include "abbe/compensate/program/program_move.h"
#include "abbe/compensate/program/word_axes.h"
#include "abbe/errors/error_set.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// A pose of a program, as programmed and corrected.
struct CorrectedNode {
  WordValues words{};                                 ///< as programmed; mm, rad
  WordValues corrected{};                             ///< the same words for the machine with errors
  std::array<double, kMaxAxes> position{};            ///< axis commands of `words`, chain order; mm, rad
  std::array<double, kMaxAxes> corrected_position{};  ///< of `corrected`
  std::array<double, 3> shift{};  ///< of the nominal functional point by the correction, workpiece frame, mm
  double position_left = 0;       ///< mm, actual point from where it shall be; NaN: not known
  double orientation_left = 0;    ///< rad
  CorrectionStatus status = CorrectionStatus::not_run;

  bool point_reached() const { return reaches_point(status); }
  /// The point is also known where it is not reached because axes are held at the end of a travel.
  bool point_known() const {
    return point_reached() || (status == CorrectionStatus::outside_travel && std::isfinite(position_left));
  }
};

/// Corrects poses given in words, with any tool length. Tools are prepared once; correct() is thread-safe and does not
/// allocate.
class NodeCorrection {
 public:
  /// @param tool_length_share  as ProgramCorrectionOptions
  NodeCorrection(const Machine& machine, const ErrorSet& errors, const WordAxes& words, const std::vector<double>& rest,
                 const CorrectionOptions& options, double tool_length_share = 0);

  /// Number of the tool of that length; prepares it where it is new. Not thread-safe.
  std::size_t tool(const std::array<double, 3>& length);
  /// Functional point of a tool from the gauge point, mm.
  const Eigen::Vector3d& tool_point(std::size_t tool) const { return tools_[tool].point; }

  /// Fills everything but `words`.
  /// @param approach  from which sides the axes come; 0: the mean of both
  void correct(ProgramCoordinates coordinates, std::size_t tool, std::span<CorrectedNode> nodes,
               const AxisApproach& approach = {}) const;

  /// Whether errors depend on the side from which axes come.
  bool has_approaches() const { return !approaches_.empty(); }
  /// The node for the errors after these approaches.
  CorrectedNode after(ProgramCoordinates coordinates, std::size_t tool, const CorrectedNode& node,
                      const AxisApproach& approach) const;

  /// A corrected node with something added to its axes, in tool centre programs through the nominal kinematics. Where
  /// that leads out of the travel, the axes are held at its end, and the status says so.
  /// @param added  [axes] mm or rad
  CorrectedNode offset(ProgramCoordinates coordinates, std::size_t tool, const CorrectedNode& node,
                       const std::array<double, kMaxAxes>& added) const;

  const WordKinematics& kinematics() const { return kinematics_; }
  const std::string& problem() const { return problem_; }

 private:
  struct Tool {
    std::array<double, 3> length;
    Eigen::Vector3d point;
    std::unique_ptr<CompensatedInverse> inverse;
  };
  void correct_block(ProgramCoordinates coordinates, const Tool& tool, const AxisApproach& approach,
                     std::span<CorrectedNode> nodes) const;

  Machine machine_;
  ErrorSet errors_;
  CorrectionOptions options_;
  double tool_length_share_;
  WordKinematics kinematics_;
  std::vector<std::size_t> held_;
  std::vector<std::size_t> approaches_;  ///< states of the kind approach that the errors use
  ChainPlan nominal_;
  std::vector<Tool> tools_;
  std::string problem_;
};

}  // namespace abbe
