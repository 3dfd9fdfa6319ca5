#pragma once

#include <array>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "liu/figure_study.h"
#include "liu/measurement.h"
#include "liu/sensitivity.h"
#include "reproduce_output.h"

namespace abbe {

/// A part with its path and what the paper says of it, um.
struct LiuMeasuredPart {
  LiuPart model;
  ScanPlan plan;
  LiuMeasurement measurement;
  double paper_before = 0, paper_after = 0;  // 0: none
};

/// All parts with the shifts of Table 3 in one unit.
struct LiuUnitResults {
  LiuUnit unit = LiuUnit::micrometre;
  LiuCalibration calibration;
  std::vector<LiuMeasuredPart> parts;
};

/// A calibration and what the standard cylinder and the sphere show with it.
struct LiuVariant {
  std::string words;
  LiuCalibration calibration;
  LiuMeasurement cylinder;
  std::vector<LiuMeasurement> spheres;  ///< 25, 50, 70 %
};

struct LiuResults {
  Machine machine;
  std::array<double, 3> reference{};  ///< mm, largest difference: nominal, mm, um
  std::array<double, 2> recursion{};  ///< mm, largest difference to the closed form: as worded, corrected
  LiuSensitivity sensitivity;
  LiuFigureStudy figures;
  std::vector<LiuUnitResults> units;
  std::vector<LiuVariant> variants;
  bool agrees = true;
};

inline constexpr double kLiuAgreement = 1e-9;  ///< mm, against the reference

std::vector<ReproducedTable> liu_tables(const LiuResults& results);
std::vector<ReproducedTable> liu_figure_tables(const LiuFigureStudy& study);
std::vector<PublishedNumber> liu_published(const LiuResults& results);
std::vector<EvaluationPlot> liu_figures(const LiuFigureStudy& study);
/// The clamping as found, with U (k = 2) from the spread of the simulated campaigns.
std::vector<EvaluationFigure> liu_headline(const LiuFigureStudy& study);
std::vector<std::string> liu_conclusions(const LiuResults& results);
std::vector<std::string> liu_corrections();
/// Machine, path over the standard cylinder and distances before and after compensation for the page.
nlohmann::json liu_page(const LiuResults& results);
/// For programs, beside the tables.
nlohmann::ordered_json liu_details(const LiuResults& results);

/// Largest of what exact readings leave in the calibrations of the stages, or in that of the clamping, mm.
double liu_exact_remainder(const LiuFigureStudy& study, bool stages);

}  // namespace abbe
