#pragma once

#include <array>
#include <vector>

#include "ma/effects.h"
#include "ma/study.h"
#include "reproduce_output.h"

namespace abbe {

inline constexpr std::size_t kMaRuns = 10;
inline constexpr double kMaAgreement = 1e-9;  ///< arcsec and mm

/// What the paper prints, in the order eps_x, eps_y, eps_z / arcsec, delta_x, delta_y, delta_z / um.
inline constexpr SixMotions kMaPaper33 = {0.0003, 0.0003, 0.0509, 0.084, 0.036, 0.028};
inline constexpr SixMotions kMaPaperBefore = {26.15, 33.36, 27.28, 37.65, 53.09, 2.66};
inline constexpr SixMotions kMaPaperAfter = {15.93, 16.69, 27.38, 12.74, 11.12, 2.57};
inline constexpr SixMotions kMaPaperRepeatability = {0.87, 1.28, 15.13, 0.74, 0.87, 0.34};
inline constexpr SixMotions kMaPaperRepeatabilityBefore = {1.92, 1.35, 15.13, 1.12, 1.36, 0.53};
inline constexpr std::array<const char*, 6> kMaMotionNames = {"eps_x",   "eps_y",   "eps_z",
                                                              "delta_x", "delta_y", "delta_z"};

/// From rad and mm to arcsec and um.
SixMotions in_ma_units(const SixMotions& motions);
/// The unit of a motion there.
const char* ma_unit(std::size_t motion);

/// All of the study. The first of two is the paper's order of the tilt of a face, the second the order of the glass.
struct MaResults {
  std::array<ReadingDifference, 2> traced{}, one_by_one{};
  std::array<MaInversions, 2> inversions;
  std::vector<PolygonPosition> positions;  ///< of section 3.3
  std::vector<MaPrismEffect> prism;
  std::vector<MaEffect> effects;
  MaTable table;
  std::vector<MaRank> ranks;
  MaSeparation separation, noise_free;
  bool agrees = true;
};

std::vector<ReproducedTable> ma_tables(const MaResults& results);
std::vector<PublishedNumber> ma_published(const MaResults& results);
std::vector<EvaluationPlot> ma_figures(const MaResults& results);
std::vector<std::string> ma_conclusions(const MaResults& results);
/// For programs, beside the tables.
nlohmann::ordered_json ma_details(const MaResults& results);

}  // namespace abbe
