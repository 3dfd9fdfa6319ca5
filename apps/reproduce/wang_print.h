#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "reproduce/wang_dials.h"

namespace abbe {

/// The parts of `abbe reproduce wang` about dials and ball bar, for people and for programs.
struct WangDialFigures {
  WangDialStudy study;
  WangDialMap map;
  std::vector<WangGridComparison> grids;
};

WangDialFigures wang_dial_figures();
void print_wang_dials(const WangDialFigures& figures);
void print_wang_ball_bar(const WangDialStudy& study, double displacements_only_mm);
nlohmann::ordered_json wang_dials_json(const WangDialFigures& figures);
nlohmann::ordered_json wang_ball_bar_json(const WangDialStudy& study);
/// Traces of the ball bar from the decoupled errors, as table and picture: {"XY.csv", text}, {"XY.svg", text}, ...
std::vector<std::pair<std::string, std::string>> wang_ball_bar_files(const WangDialStudy& study);

/// Simulated indications of all six axes as files that --grids reads: {"X.csv", text}, ...
std::vector<std::pair<std::string, std::string>> wang_indication_files(const WangDialStudy& study);

}  // namespace abbe
