#pragma once

#include <optional>
#include <string>
#include <vector>

#include "abbe/formats/evaluations/section_file.h"
#include "abbe/formats/shapes/point_cloud_file.h"
#include "abbe/machine/machine.h"
#include "abbe/verify/parts/contour_error.h"
#include "abbe/verify/parts/contour_sections.h"

namespace abbe {

// Contour errors of an engraved curve for evaluate_readings(); lengths in mm, angles in rad. A tolerance of the largest
// contour error also stands in the drawing of the page. Methods: docs/contour-error.md.

/// Cross-sections of an engraved curve. The evaluation is refused where a section has no answer: a mean that some
/// sections have no part in is not the one that was asked for.
struct SectionsTest {
  std::vector<SectionReadings> readings;
  SectionOptions options;           ///< its `edge.beam_tilt` is set here
  std::optional<double> beam_tilt;  ///< --beam-tilt-deg: of sections that do not state theirs, one at least; else zero
};

/// Points on an engraved curve against the commanded one.
struct ContourPointsTest {
  PointCloudFile readings;           ///< frame of the curve
  std::vector<CommandPiece> pieces;  ///< --curve: one at least
  double origin_uncertainty = 0;     ///< --u-origin-um: standard, of the points' place against the curve, common to all
};

/// What the tool leaves of a commanded curve on the workpiece.
/// @param curve    file as read_curve() takes it
/// @param machine  file of the machine whose axes the curve sets beforehand; empty: it sets none
/// @param closed   --closed: the last point is followed by the first
/// @throws InputError as read_curve() and commanded_pieces(), and for a curve that sets axes where there is no machine
std::vector<CommandPiece> read_commanded_pieces(const std::string& curve, const std::string& machine = "",
                                                bool closed = false);
/// The same on a machine that has already been read.
std::vector<CommandPiece> read_commanded_pieces(const std::string& curve, const Machine& machine, bool closed = false);

}  // namespace abbe
