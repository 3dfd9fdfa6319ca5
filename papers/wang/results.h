#pragma once

#include <string>
#include <vector>

#include "reproduce_output.h"
#include "wang/dial_tables.h"
#include "wang/figures.h"
#include "wang/study.h"

namespace abbe {

/// How many of the tables' columns 12 are the mean of columns 1 to 11 with further digits cut off.
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
  WangMap grid;         ///< E at four positions per axis, angles in degrees as printed
  bool agrees = false;  ///< E at the zero pose, with the numbers of an independent program (tests/golden/wang)
};
WangResults wang_results(int threads);

/// What the paper prints at its zero pose, mm: (42) to (45).
struct WangPrinted {
  Eigen::Vector3d tool{193.93746, 1.72736, -4.4856}, workpiece{-5.5402, -1.8824, 399.9592},
      complete{0.52234, -3.60976, -4.5264}, displacements{0.001, 0.0027, -0.0002};
};

std::vector<ReproducedTable> wang_tables(const WangResults& results);
std::vector<PublishedNumber> wang_published(const WangResults& results);
/// More for programs; units in the keys.
nlohmann::ordered_json wang_details(const WangResults& results);
/// Map, distributions and machine for the page.
nlohmann::json wang_page(const WangResults& results);
/// Machine, errors, maps of E, readings of dials and laser.
void write_wang_study(const WangResults& results, ResultsFolder& folder);

}  // namespace abbe
