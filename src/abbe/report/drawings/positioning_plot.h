#pragma once

#include <string>

#include "abbe/report/drawings/svg_drawing.h"
#include "abbe/verify/evaluations/diagonals.h"
#include "abbe/verify/evaluations/positioning.h"

namespace abbe {

/// Mean deviations over the target positions from both sides with mean +- 2 s as bands, and A, E, R and B where they
/// come from. What was not evaluated is not drawn. mm and um, or degrees and arcsec.
SvgPicture positioning_plot(const PositioningEvaluation& evaluation, bool rotary, const std::string& title);

/// Mean deviations of all diagonals over the distance along them, one colour each, from both sides.
SvgPicture diagonals_plot(const DiagonalsEvaluation& evaluation, const std::string& title);

}  // namespace abbe
