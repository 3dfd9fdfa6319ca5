#pragma once

#include <string>
#include <vector>

#include "ma/study.h"

namespace abbe {

/// One of the errors of the model and what it does to the readings of the six motions.
struct MaEffect {
  std::string symbol;  ///< of the paper: "eps_xbc"
  std::string words;   ///< what it is
  bool is_angle = true;
  double size = 0;      ///< rad or mm
  SixMotions change{};  ///< largest change over the positions for that size: rad and mm
};

/// Table 1: what one second of arc of each error of the prism does; instruments where section 3.3 puts them, all other
/// errors zero.
struct MaPrismEffect {
  MaEffect effect;
  std::array<bool, 6> paper{};  ///< marked in Table 1
  std::array<bool, 6> found{};  ///< not zero here

  bool agrees() const { return paper == found; }
};
std::vector<MaPrismEffect> ma_prism_effects();

/// The 46 errors of the model with their size in section 3.3 and their effect there.
///
/// The paper counts 46 and lists none: 6 motions, 5 of the installation of the prism, 5 of the prism, 3 angles and 3
/// coordinates of each of the five instruments add up to it. Motions count in full; errors of installation by what
/// they change against the first position, those of a face by what they change at their own.
std::vector<MaEffect> ma_all_effects();

}  // namespace abbe
