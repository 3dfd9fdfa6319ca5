#pragma once

#include <vector>

#include "liu/profiles.h"
#include "liu/simulation.h"

namespace abbe {

/// The calibrations of section 4.2 with the shifts of Table 3 in one unit.
struct LiuClampingStudy {
  LiuUnit unit = LiuUnit::micrometre;
  LiuClampingErrors truth{};
  LiuCampaign exact, noisy, tapered;  ///< exact readings; noise of Table 2; exact, standard with 14 um of taper
  LiuJointClamping joint;
  LiuClampingSpreads spread;
};

/// All of Figures 4b, 6 to 9 and 11b.
struct LiuFigureStudy {
  LiuReferenceClamping reference;
  std::vector<LiuClampingStudy> clampings;  ///< millimetres, micrometres
  std::vector<LiuProfile> clamped;          ///< Figure 4b: one section each
  std::vector<LiuProfile> corrected;        ///< Figure 9
  std::vector<LiuRepeats> repeats;          ///< Figure 11b
  bool complete() const;                    ///< everything converged

  const LiuClampingStudy& micrometres() const { return clampings.back(); }
};

inline constexpr double kLiuTaper = 0.014 / 23.5;  ///< mm/mm: the cylindricity of Table 2 over the measured length
inline constexpr double kLiuClampingHeight = 10;   ///< mm, of the sections of Figure 4b

/// @param campaigns  simulated calibrations behind the spread of the clamping errors
LiuFigureStudy liu_figure_study(const Machine& machine, std::size_t campaigns);

}  // namespace abbe
