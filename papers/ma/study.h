#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "abbe/instruments/polygon/polygon_campaign.h"
#include "abbe/instruments/polygon/polygon_separation.h"

namespace abbe {

/// Ma et al. (2021), Applied Sciences 11, 3960: six motions of a rotary table by a polygon prism.

/// Section 3.3 of the paper: 13 positions from 0 to 360 degrees.
///
/// The paper gives the faces seen along x and along y at one position the same working-angle error and tilts of
/// opposite sign, which no prism has. `polygon.faces` therefore lists 13 planes seen along x, then 13 seen along y.
struct MaExample {
  Polygon polygon;
  PolygonMount mount;
  PolygonBench bench;
  std::vector<PolygonPosition> positions;
  std::vector<TableMotion> motions;
};

/// @throws InputError if the file with the numbers (golden/ma) is not found or not as expected
MaExample ma_example(PolygonFaceOrder order);

/// Readings of the example computed by an independent program, [13].
std::vector<PolygonReadings> read_ma_reference(PolygonFaceOrder order);

/// Largest difference of two sets of readings; rad and mm.
struct ReadingDifference {
  double angle = 0, length = 0;
};
ReadingDifference largest_difference(const std::vector<PolygonReadings>& a, const std::vector<PolygonReadings>& b);

/// Readings of the example, position by position and by the vectorised trace.
std::vector<PolygonReadings> ma_readings(const MaExample& example);
std::vector<PolygonReadings> ma_traced(const MaExample& example);

inline constexpr double kMicrometre = 1e-3;  ///< mm

/// Largest absolute values of six motions: eps_x, eps_y, eps_z (rad), delta_x, delta_y, delta_z (mm).
using SixMotions = std::array<double, 6>;

/// The readings from which eps_x, eps_y, eps_z, delta_x, delta_y, delta_z are found.
inline constexpr std::array<PolygonReading, 6> kMaReadingOf = {
    PolygonReading::autocollimator_y_about_x, PolygonReading::autocollimator_x_about_y,
    PolygonReading::autocollimator_x_about_z, PolygonReading::displacement_x,
    PolygonReading::displacement_y,           PolygonReading::displacement_z};

/// How far each way of evaluating section 3.3 misses the motions that were set.
struct MaInversions {
  SixMotions printed{}, corrected{}, stepwise{}, simultaneous{};
  /// Found minus set at every position (Figure 3), signed.
  std::vector<SixMotions> printed_at, corrected_at, simultaneous_at;
  bool all_converged = false;
};
MaInversions ma_inversions(const MaExample& example);

/// Motions position by position over all runs.
struct MaCourses {
  std::vector<SixMotions> mean, half_range;  ///< [positions]; half of the peak-to-peak value
};

/// Runs of a table like the SKQ-12200 of section 4, measured stepwise with one autocollimator and one sensor.
struct MaTable {
  /// Table 3: largest motion over the positions, mean of the runs.
  SixMotions before{};    ///< readings minus the first one, nothing else taken into account
  SixMotions fitted{};    ///< minus a constant, a cosine and a sine fitted to every run, as the paper does
  SixMotions inverted{};  ///< exact inversion, prism and installation known
  SixMotions truth{};     ///< what the table did
  SixMotions absorbed{};  ///< true motion that the fit took for installation
  /// Section 4: half the peak-to-peak value of the runs, largest over the positions.
  SixMotions repeatability_before{}, repeatability_fitted{}, repeatability_inverted{}, repeatability_truth{};
  std::vector<double> angles;  ///< of the positions, rad
  MaCourses courses_before, courses_fitted, courses_inverted, courses_truth;
};
MaTable ma_table(std::size_t runs, std::uint64_t seed);

/// A campaign on that table, with errors of prism and installation as large as the paper's.
/// @param shifts  by how many faces the prism is turned in each mount
PolygonCampaign ma_campaign(const std::vector<std::size_t>& shifts, std::uint64_t seed);

/// One line of the rank table.
struct MaRank {
  std::string words;
  std::vector<std::size_t> shifts;
  double mirror_lever = 0;  ///< of the sensor along z, mm
  std::size_t unknowns = 0, readings = 0, rank = 0;
};
std::vector<MaRank> ma_rank_table();

/// Two mounts, the second turned by one face: motions after the gauge against the truth.
struct MaSeparation {
  PolygonSeparation result;
  std::vector<PolygonGaugeEquation> gauge;
  SixMotions error{};        ///< largest difference to the truth in the same gauge
  SixMotions uncertainty{};  ///< largest stated standard uncertainty
  SixMotions confused{};     ///< what one mount alone would call motion: largest difference to the same truth
  double azimuth_error = 0, tilt_error = 0, distance_error = 0;  ///< of the faces, largest; rad and mm
};
/// @param noise  zero: only what the gauge of first order leaves at second order
MaSeparation ma_separation(const PolygonNoise& noise, bool noisy, std::uint64_t seed);

}  // namespace abbe
