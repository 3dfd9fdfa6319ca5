#pragma once

#include <string>
#include <vector>

#include "reproduce_output.h"
#include "wang/ball_bar.h"
#include "wang/dials.h"

namespace abbe {

/// The parts of `abbe reproduce wang` about dials and ball bar, computed once for tables, plots and JSON.
struct WangDialFigures {
  WangDialStudy study;
  WangDialMap map;
  std::vector<WangGridComparison> grids;
  WangBallBarStudy ball_bar;
};

WangDialFigures wang_dial_figures();
/// One dial over two faces, what is found of the 36 errors, and what a ball bar would read.
std::vector<ReproducedTable> wang_dial_tables(const WangDialFigures& figures);
/// Traces of the ball bar from the decoupled errors.
std::vector<EvaluationPlot> wang_ball_bar_plots(const WangBallBarStudy& bar);

/// For programs, beside the tables.
nlohmann::ordered_json wang_dials_json(const WangDialFigures& figures);
nlohmann::ordered_json wang_ball_bar_json(const WangBallBarStudy& bar);

}  // namespace abbe
