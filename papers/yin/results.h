#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "reproduce_output.h"
#include "yin/commands.h"
#include "yin/contour.h"
#include "yin/equations.h"
#include "yin/marks.h"
#include "yin/scans.h"

namespace abbe {

/// What the paper measured, um.
inline constexpr YinFigures kYinMeasured = {15.1, 29.5, 6.8};

/// All of the study.
struct YinResults {
  YinSteps table_moves, head_moves;
  YinJointFit joint;
  std::vector<YinEquation> equations;  ///< (1) to (8)
  YinPositioning positioning;
  std::vector<YinAxisCommands> commands;  ///< of Table A4
  YinScans scans;
  YinScansFound located;
  YinContour contour;
  YinSections sections;
  std::vector<std::string> failures;  ///< what was to be found and is not, in words
  bool agrees = false;                ///< with the reference to 1e-9 mm, and nothing failed
};

/// All of it. Without a position of the workpiece there is no contour: its parts stay empty.
YinResults yin_results(std::uint64_t seed);
/// Fills failures and agrees from the rest.
void judge(YinResults& results);

std::vector<ReproducedTable> yin_tables(const YinResults& results);
std::vector<PublishedNumber> yin_published(const YinResults& results);
std::vector<EvaluationPlot> yin_plots(const YinResults& results);
/// What the page shows above everything: the contour error, measured and predicted.
std::vector<EvaluationFigure> yin_headline(const YinResults& results);
/// The sections of the simulated part, for the page; null without them.
nlohmann::json yin_page(const YinResults& results);
/// More for programs; units in the keys.
nlohmann::ordered_json yin_details(const YinResults& results);
/// All of it, as it is shown and written.
Reproduction yin_reproduction(const YinResults& results);

}  // namespace abbe
