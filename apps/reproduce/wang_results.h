#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "reproduce/wang_figures.h"
#include "reproduce/wang_print.h"
#include "reproduce/wang_study.h"

namespace abbe {

/// How many of the tables' columns 12 are the cut-off mean of columns 1 to 11.
struct WangMeanColumn {
  int rows = 0, equal = 0;
};

/// |E| over all combinations of the rows, in one reading of the tables.
struct WangPopulationRow {
  std::string name;
  WangReading reading;
  WangPopulation population;
};

/// All that `abbe reproduce wang` computes.
struct WangResults {
  WangError degrees, millidegrees, displacements;  ///< at the paper's zero pose
  WangMeanColumn mean_column;
  std::vector<WangPopulationRow> populations;
  std::vector<WangPoints> points;
  WangConclusions conclusions;
  WangDialFigures dials;
};
WangResults wang_results(int threads);

/// The paper's zero pose: first column of every table, B at 0 degrees (its seventh).
std::vector<double> wang_zero_pose();

/// For programs; units in the keys.
nlohmann::ordered_json wang_json(const WangResults& results);
/// For people, on stdout.
void print_wang(const WangResults& results);
/// Maps of E, tables, machine, errors, figures and page.
void write_wang_folder(const WangResults& results, const std::filesystem::path& output);

}  // namespace abbe
