#pragma once

// Volumetric error of a mill that is out of square:
//
//   #include <abbe/machine/chain.h>
//   #include <abbe/verify/error_map.h>
//
//   #include <cstdio>
//
//   int main() {
//     const abbe::Machine mill = abbe::parse_chain("w X' Y' b Z t").machine;
//     abbe::ErrorSet errors;  // EC0Y, squareness of Y to X: 20 um/m; EA0Z, of Z to Y: -30 um/m
//     errors.locations.push_back({.axis = mill.find_axis("Y"), .component = abbe::Component::C, .value = 20e-6});
//     errors.locations.push_back({.axis = mill.find_axis("Z"), .component = abbe::Component::A, .value = -30e-6});
//
//     const std::vector<double> positions = abbe::evenly_spaced(-200, 200, 9);  // mm
//     const abbe::PoseSource poses = abbe::pose_source(abbe::PoseGrid{{positions, positions, positions}});
//     abbe::ErrorMapOptions options;
//     options.remove_rigid_motion = true;  // the datum of the workpiece is set where it fits best
//     const abbe::ErrorMap map = abbe::error_map(mill, errors, nullptr, poses, options);
//     std::printf("volumetric error of %zu poses: mean %.2f um, 95 %% below %.2f um, largest %.2f um\n", map.count(),
//                 1e3 * map.statistics.mean, 1e3 * map.statistics.p95, 1e3 * map.statistics.maximum);
//     for (const abbe::ErrorShare& part : abbe::shares_by_axis(mill, errors, poses)) {
//       std::printf("%s alone: mean %.2f um\n", part.name.c_str(), 1e3 * part.mean);
//     }
//     return map.statistics.excluded == 0 ? 0 : 1;
//   }
//
// It prints:
//
//   volumetric error of 729 poses: mean 3.04 um, 95 % below 5.04 um, largest 6.16 um
//   X alone: mean 0.00 um
//   Y alone: mean 2.22 um
//   Z alone: mean 3.33 um
//
// verify holds judgements:
//   error_map.h, volumetric_figures.h   deviations over a volume; the figures that all commands state
//   evaluations/positioning.h           ISO 230-2; circular.h, straightness.h, diagonals.h and others beside it
//   compensated_poses.h, table_loss.h   what a compensation, or a control with a table, leaves
//   parts/contour_error.h               test pieces, contours and scans against what they should be
//   uncertainty_budget.h                budgets by sensitivities and by drawing

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "abbe/errors/chain_plan.h"
#include "abbe/errors/poses.h"
#include "abbe/geometry/numbered_work.h"
#include "abbe/geometry/rigid_transform.h"
#include "abbe/verify/evaluations/statistics.h"

namespace abbe {

/// Parameters of an ErrorSet that are uncertain.
struct ParameterCovariance {
  std::vector<std::size_t> parameters;  ///< indices into ErrorSet::parameters()
  Eigen::MatrixXd covariance;           ///< [n, n], mm and rad
};

struct ErrorMapOptions {
  bool orientation = true;                          ///< also the deviation of the orientation
  const ParameterCovariance* covariance = nullptr;  ///< of `actual`'s parameters: gives standard uncertainties
  /// Remove the rigid motion that makes the displacements smallest (least squares over the poses in range): the
  /// deviation then does not depend on where the workpiece datum was set.
  bool remove_rigid_motion = false;
  int threads = 0;                                                    ///< 0: all
  std::function<void(std::size_t done, std::size_t total)> progress;  ///< in poses; one thread at a time
  /// Who computes the blocks of poses; empty: this process. Of several processes the first one alone gets the map; the
  /// others get their own blocks of it, and poses of the rest are not covered.
  WorkDriver work{};
};

/// Deviations of the functional point and the tool's orientation in the workpiece frame, structure of arrays.
struct ErrorMap {
  std::array<std::vector<double>, 3> point;         ///< where `reference` puts the functional point, mm
  std::array<std::vector<double>, 3> displacement;  ///< actual minus reference, mm
  std::array<std::vector<double>, 3> rotation;      ///< rotation vector of R_actual R_reference^T, rad; or empty
  std::vector<double> norm;                         ///< of the displacement: the volumetric error, mm
  /// Standard uncertainties of the three displacements (mm), the three rotations (rad), or empty.
  std::array<std::vector<double>, 6> uncertainty;
  std::vector<double> norm_uncertainty;  ///< along the displacement (its largest direction where that is 0), mm
  std::vector<std::uint8_t> covered;     ///< 0: outside the range of an error motion, not a result
  RigidTransform removed;                ///< rigid motion taken out of `actual`, identity if none
  SampleStatistics statistics;           ///< of norm, over covered poses

  std::size_t count() const { return norm.size(); }
};

/// Volumetric error at poses.
///
/// Before: reference = nullptr (nominal machine, no errors). After: actual = truth, reference = identified; or any two
/// sets. The functional point is Machine::tool_offset from the gauge point, displaced by each set's own
/// tool_offset_error.
/// @throws std::invalid_argument if poses have not one position per axis or the covariance has the wrong size
/// Source: ISO 230-1:2012, 3.4 (deviation = actual - nominal); JCGM 100, 5.2.2 for the uncertainty P Cov P'.
ErrorMap error_map(const Machine& machine, const ErrorSet& actual, const ErrorSet* reference, const PoseSource& poses,
                   const ErrorMapOptions& options = {});

/// One block of a streamed map; valid during the call only. Arrays as in ErrorMap, [count].
struct ErrorMapBlock {
  std::size_t first = 0;
  std::size_t count = 0;
  const double* const* axis = nullptr;
  ConstPointArrays point;
  ConstPointArrays displacement;
  ConstPointArrays rotation;  ///< null pointers if not wanted
  const double* norm = nullptr;
  const double* const* uncertainty = nullptr;  ///< null or six (three without orientation) arrays
  const double* norm_uncertainty = nullptr;
  const std::uint8_t* covered = nullptr;
};

/// As error_map() for any number of poses: `visit` is called for every block, from several threads, in any order; block
/// i covers poses i * 4096 and following. options.remove_rigid_motion costs a second pass; options.work is not used.
/// @returns statistics of the norm, exact; 8 bytes per pose are kept for the percentiles, nothing else
SampleStatistics stream_error_map(const Machine& machine, const ErrorSet& actual, const ErrorSet* reference,
                                  const PoseSource& poses, const ErrorMapOptions& options,
                                  const std::function<void(const ErrorMapBlock&)>& visit);

/// How much one group of errors contributes.
struct ErrorShare {
  std::string name;    ///< "translations", "rotations", "locations", "tool", or an axis name
  double mean = 0;     ///< mean norm with only this group present, mm
  double maximum = 0;  ///< mm
  /// Sum over poses of d_group . d_all / sum of d_all . d_all: shares add up to 1 to first order; may be negative.
  double share = 0;
};

/// Shares of translational and rotational error motions, location errors and tool offset.
std::vector<ErrorShare> shares_by_kind(const Machine& machine, const ErrorSet& errors, const PoseSource& poses,
                                       int threads = 0);
/// Shares per axis, motions and location errors together.
std::vector<ErrorShare> shares_by_axis(const Machine& machine, const ErrorSet& errors, const PoseSource& poses,
                                       int threads = 0);

}  // namespace abbe
