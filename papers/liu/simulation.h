#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "liu/cylinder.h"
#include "liu/machine.h"

// The simulated calibrations of section 4.2. Lengths in mm, angles in rad.
namespace abbe {

/// Figures 6 to 8: the four patches of a calibration, [place] along by across, and what the calibration leaves there.
struct LiuPlaces {
  std::array<std::vector<double>, kLiuQuarters> measured;  ///< height of the surface as measured
  std::array<std::vector<double>, kLiuQuarters> nominal;   ///< of the cylinder turned about the nominal axis
  std::array<std::vector<double>, kLiuQuarters> found;     ///< of the cylinder turned about the axis found
  /// Equation (11): virtual less measured height.
  std::vector<double> remaining(std::size_t quarter) const;
  std::vector<double> nominal_difference(std::size_t quarter) const;
};
double largest_magnitude(const std::vector<double>& values);

/// How the standard and the scanner are in a calibration.
struct LiuCase {
  std::string words;
  LiuNoise noise;
  double taper = 0;
  std::uint64_t run = 0;  ///< other noise
};

/// Section 4.2.1: location errors of a stage from the cylinder at 0, 90, 180 and 270 degrees.
struct LiuStageCalibration {
  bool converged = false;
  ErrorSet errors;  ///< as identified
  LiuPlaces places;
};
/// @param known  errors of the stages calibrated before
LiuStageCalibration liu_simulate_stage(const Machine& machine, const std::string& stage, const ErrorSet& truth,
                                       const ErrorSet& known, const LiuCase& how);

/// The four clamping errors: tilts about x and z (their rotations are applied in this order), shifts along x and z.
using LiuClampingErrors = std::array<double, 4>;
LiuClampingErrors liu_clamping_errors(const LiuAxisLine& line);
/// workpiece_from_part of clamping errors.
RigidTransform liu_clamped(const LiuClampingErrors& errors);

/// Section 4.2.2: the clamping from the cylinder at four angles of C.
struct LiuClampingCalibration {
  bool converged = false;
  LiuClampingErrors found{};
  LiuClampingErrors uncertainty{};  ///< standard, of the fit: the axes taken as calibrated
  LiuScan readings;
  LiuPlaces places;
};
/// @param calibrated  what the evaluation takes the stages for
LiuClampingCalibration liu_simulate_clamping(const Machine& machine, const ErrorSet& truth, const ErrorSet& calibrated,
                                             const LiuClampingErrors& clamping, const LiuCase& how);
/// The same from exact readings of an independent program (tests/golden/liu/clamp_exact.csv): shifts of Table 3 in
/// millimetres, the clamping in the frame of the true axis of C, the first tilt towards x and the second towards z.
struct LiuReferenceClamping {
  bool converged = false;
  double difference = 0;  ///< mm, largest between the axis found and the one of the readings, 12 mm from the middle
  double remaining = 0;   ///< mm, largest deviation of an indication
};
LiuReferenceClamping liu_reference_clamping(const Machine& machine);

/// Steps (a), (b), (c) of section 4.2, one after another.
struct LiuCampaign {
  LiuStageCalibration a, c;
  LiuClampingCalibration clamping;
  bool converged() const { return a.converged && c.converged && clamping.converged; }
};
LiuCampaign liu_campaign(const Machine& machine, const ErrorSet& truth, const LiuClampingErrors& clamping,
                         const LiuCase& how);

/// The clamping if both stages and the clamping are fitted together from the readings of a campaign: the uncertainties
/// of the axes are in those of the clamping.
struct LiuJointClamping {
  bool converged = false;
  LiuClampingErrors found{}, uncertainty{};
};
/// @param run  of the noise of Table 2
LiuJointClamping liu_joint_clamping(const Machine& machine, const ErrorSet& truth, const LiuClampingErrors& clamping,
                                    std::uint64_t run);

/// Found minus true clamping errors of campaigns with the noise of Table 2.
struct LiuClampingSpread {
  std::size_t campaigns = 0;
  LiuClampingErrors mean{}, deviation{};  ///< mean and standard deviation
};
struct LiuClampingSpreads {
  LiuClampingSpread steps, joint;  ///< the same readings, in steps (a), (b), (c) and by one fit
};
LiuClampingSpreads liu_clamping_spreads(const Machine& machine, const ErrorSet& truth,
                                        const LiuClampingErrors& clamping, std::size_t campaigns);

}  // namespace abbe
