#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "abbe/identify/linkage/decoupled_errors.h"
#include "abbe/identify/linkage/dial_grid_as_printed.h"
#include "abbe/verify/evaluations/statistics.h"

namespace abbe {

/// Half of the paper's expanded uncertainties (95 %) of 0.022 um (laser) and 1.2 um (dial): standard uncertainty, mm.
inline constexpr double kWangLaserUncertainty = 0.011e-3;
inline constexpr double kWangDialUncertainty = 0.6e-3;

/// One axis of the simulated campaign.
struct WangDialAxis {
  std::size_t table = 0;     ///< 0 to 5: X Y Z A B C
  AxisIndications readings;  ///< with noise
  Decoupling without_noise, with_noise;
  Eigen::MatrixXd truth;  ///< [11, 6] mm, rad, with the same datum, computed without the decoupling
  /// Largest magnitude over the positions of without_noise less truth, mm, then rad.
  double bias_mm = 0, bias_rad = 0;

  /// With noise, over the positions; mm or rad.
  double largest_standard_uncertainty(std::size_t component) const;
};

/// The grinder of Tables A1 to A6 (angles in millidegrees, measured rows 1 to 11), measured axis by axis.
///
/// Linear axes: four dials on a carriage on one face, three on the other, a laser along the motion. Rotary axes: two
/// dials at right angles at two heights of a mandrel with eccentricity and wobble, one probe on its end; the paper's
/// instruments cannot see the rotation about the axis itself, for which an angle standard (U95 = 1 arcsec) is added.
/// Dials have zeros of their own and faces are inclined; angles are zero at the first position.
struct WangDialStudy {
  std::vector<WangDialAxis> axes;             ///< X Y Z A B C
  DecoupledErrors without_noise, with_noise;  ///< 36 error motions; chain order C X Z A Y B
  std::size_t seen_by_dials = 0;              ///< of the 36: 33
  std::size_t values = 0, inside = 0;         ///< error values with an uncertainty; within k = 2 of the noise-free ones
};
WangDialStudy wang_dial_study(std::uint64_t seed);

/// E of equation (18) from the decoupled errors, with its uncertainty.
struct WangDialMap {
  std::size_t poses = 0;
  SampleStatistics norm;                                ///< |E| by the error motions found, mm
  SampleStatistics uncertainty;                         ///< standard uncertainty along it, mm
  double inside = 0;                                    ///< share of components within k = 2 of those without noise
  Eigen::Vector3d zero_pose = Eigen::Vector3d::Zero();  ///< E at the paper's zero pose, mm
  Eigen::Vector3d zero_pose_uncertainty = Eigen::Vector3d::Zero();  ///< mm
};
WangDialMap wang_dial_map(const WangDialStudy& study);

/// One dial over grids on two faces of a linear axis, without noise: zeros 50 and -20 um, settings 30 and -20 urad.
struct WangGridComparison {
  std::string axis;
  double dial_range_mm = 0;  ///< what the dial would have to travel with the angles in degrees as printed
  double printed_second = 0, printed_first = 0, printed_roll = 0;  ///< rms bias of (5), (8) in mm, of (11) in rad
  double printed_pitch = 0, true_pitch = 0;                        ///< (7) and the table's constant, rad
  double printed_yaw = 0, true_yaw = 0;                            ///< (10)
  double correct_second = 0, correct_first = 0, correct_roll = 0;  ///< the same of the correct form
};
std::vector<WangGridComparison> wang_grid_comparison();

}  // namespace abbe
