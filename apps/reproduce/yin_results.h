#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "abbe/report/evaluation_report.h"
#include "reproduce/yin_commands.h"
#include "reproduce/yin_contour.h"
#include "reproduce/yin_equations.h"
#include "reproduce/yin_marks.h"
#include "reproduce/yin_scans.h"

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

/// For programs; units in the keys.
nlohmann::ordered_json yin_json(const YinResults& results);
/// For people, on stdout.
void print_yin(const YinResults& results);
/// Figures, plots and tables for the page of a results folder.
EvaluationReport yin_report(const YinResults& results);

}  // namespace abbe
