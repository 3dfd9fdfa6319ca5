#pragma once

#include <array>
#include <string>
#include <vector>

#include "liu/simulation.h"

// Profiles of the standard cylinder in turns of C: Figures 4b, 9 and 11b. Lengths in mm, angles in rad.
namespace abbe {

/// One turn of C at a height, without noise: what an evaluation takes for the section of the cylinder.
struct LiuSection {
  double height = 0;
  std::vector<double> angle;        ///< of C
  std::vector<double> distance;     ///< from y
  double x = 0, z = 0, radius = 0;  ///< of the least-squares circle across y
  double out_of_round = 0;          ///< peak to valley of the distances from its centre
};

/// How a cylinder is scanned and evaluated.
struct LiuSectionCase {
  std::string words;
  ErrorSet actual;         ///< errors of the stages
  ErrorSet evaluated;      ///< those that the evaluation takes into account
  RigidTransform clamped;  ///< workpiece_from_part
  RigidTransform removed;  ///< the clamping that the evaluation takes out
};

/// Sections at several heights and what they have in common.
struct LiuProfile {
  std::string words;
  std::vector<LiuSection> sections;
  double lean = 0;          ///< rad, by how much the centres run off along y
  double growth = 0;        ///< mm/mm, of the radius along y
  double out_of_round = 0;  ///< largest of the sections
  double deviation = 0;     ///< largest distance of a point from the cylinder of 10 mm about y
};
LiuProfile liu_profile(const Machine& machine, const LiuSectionCase& how, const std::vector<double>& heights);

/// The chuck's true axis as a place for the cylinder: clamped without clamping errors.
RigidTransform liu_on_stage_axis(const Machine& machine, const ErrorSet& errors);

/// Figure 11b: the standard cylinder measured four times along one path.
struct LiuRepeats {
  static constexpr std::size_t kRuns = 4, kLines = 5, kSteps = 72;
  std::string words;
  bool complete = false;  ///< calibrated and all cylinders fitted
  std::array<double, kLines> heights{};
  std::array<std::vector<double>, kRuns> deviations;  ///< [line by line] distance from the run's axis less its radius
  std::array<double, kRuns> rms{}, radius{};
  double repeatability = 0;  ///< standard deviation at one place, over the runs, pooled
  double correlation = 0;    ///< mean of the correlation coefficients between runs
};
/// @param calibration  the standard and the scanner when the stages were calibrated
/// @param lobes        mm, amplitude of three lobes of the standard
LiuRepeats liu_repeats(const Machine& machine, const ErrorSet& truth, const LiuClampingErrors& clamping,
                       const LiuCase& calibration, double lobes);

}  // namespace abbe
