#pragma once

#include <array>
#include <string>

#include "abbe/report/drawings/svg_drawing.h"
#include "abbe/verify/evaluations/diagonals.h"
#include "abbe/verify/evaluations/positioning.h"

namespace abbe {

/// Texts of positioning_plot() beside its title.
struct PositioningPlotWords {
  std::string position, deviation;   ///< labels of the axes, with units
  std::array<std::string, 2> means;  ///< of positive and negative approach
  std::string band;                  ///< mean +- 2 s
  std::string bidirectional_mean;
};
PositioningPlotWords english_plot_words(bool rotary);

/// Mean deviations over the target positions from both sides with mean +- 2 s as bands, and A, E, R and B where they
/// come from. What was not evaluated is not drawn. mm and um, or degrees and arcsec.
SvgPicture positioning_plot(const PositioningEvaluation& evaluation, bool rotary, const std::string& title,
                            const PositioningPlotWords& words);
SvgPicture positioning_plot(const PositioningEvaluation& evaluation, bool rotary, const std::string& title);

/// Mean deviations of all diagonals over the distance along them, one colour each, from both sides.
SvgPicture diagonals_plot(const DiagonalsEvaluation& evaluation, const std::string& title);

}  // namespace abbe
