#pragma once

#include <string>
#include <utility>
#include <vector>

#include "reproduce/reproduce_output.h"
#include "reproduce/wang_dials.h"

namespace abbe {

/// The parts of `abbe reproduce wang` about dials and ball bar, as tables, plots and JSON.
struct WangDialFigures {
  WangDialStudy study;
  WangDialMap map;
  std::vector<WangGridComparison> grids;
};

WangDialFigures wang_dial_figures();
/// One dial over two faces, what is found of the 36 errors, and what a ball bar would read.
std::vector<ReproducedTable> wang_dial_tables(const WangDialFigures& figures);
nlohmann::ordered_json wang_dials_json(const WangDialFigures& figures);
nlohmann::ordered_json wang_ball_bar_json(const WangDialStudy& study);
/// Traces of the ball bar from the decoupled errors.
std::vector<EvaluationPlot> wang_ball_bar_plots(const WangDialStudy& study);

/// Simulated indications of all six axes as files that --grids reads: {"X.csv", text}, ...
std::vector<std::pair<std::string, std::string>> wang_indication_files(const WangDialStudy& study);

}  // namespace abbe
