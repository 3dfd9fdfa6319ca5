#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "abbe/errors/error_set.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// One indicator of displacement that is read at every position of one axis: a dial in one place of a grid or carriage,
/// a laser interferometer.
struct DisplacementProbe {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< unit; a body displaced this way raises the indication
  Eigen::Vector3d place = Eigen::Vector3d::Zero();       ///< mm, from the axis's point, in machine directions
  double standard_uncertainty = 0;                       ///< of one indication, mm, > 0
};

/// Indications of several probes at the positions of one axis whose direction is X, Y or Z.
///
/// Linear axis: places move with the carriage. Rotary axis: places stay on the bed and the probes touch a mandrel.
struct AxisIndications {
  AxisKind kind = AxisKind::linear;
  std::size_t direction = 0;              ///< of the axis: 0 X, 1 Y, 2 Z
  double sense = 1;                       ///< Axis::sense()
  std::vector<double> positions;          ///< [m] commands, increasing, mm or rad
  std::vector<DisplacementProbe> probes;  ///< [k]
  Eigen::MatrixXd indications;            ///< [m, k] mm
};

/// The zero of an angle is set by the faces and the dials' own zeros, not by the motion: which one is taken.
enum class AngleDatum { as_indicated, zero_at_first_position, zero_mean };

enum class DecouplingStatus { not_run, ok, combination_only, nothing_seen, too_few_positions };

/// Error motions of one axis found from indications; everything in it is a linear function of the readings.
struct Decoupling {
  DecouplingStatus status = DecouplingStatus::not_run;
  std::string message;                       ///< why not ok, in words
  std::vector<std::string> notes;            ///< what the figures contain or leave open, in words
  std::array<bool, kComponentCount> seen{};  ///< which of X Y Z A B C the readings determine
  std::vector<double> positions;             ///< [m] mm or rad
  Eigen::MatrixXd errors;                    ///< [m, 6] mm, rad; columns not seen are 0
  Eigen::MatrixXd covariance;                ///< [6 m, 6 m] of errors column by column: index component * m + i
  /// What the datum took away, per component: linear axis, straightness {value at position 0, slope per mm}; angle {its
  /// zero}; rotary axis, axial {mean}; radial and tilt {constant, cosine, sine of what turns with the mandrel}.
  std::array<std::vector<double>, kComponentCount> removed;
  double chi_square = 0;               ///< of the misfit, after a constant per probe
  std::size_t degrees_of_freedom = 0;  ///< (m - 1) (k - components seen)
  Eigen::VectorXd probe_offset;        ///< [k] constant misfit of each probe: faces out of parallel, mm

  double standard_uncertainty(Component component, std::size_t position) const;
};

/// Least squares per position, then the datum.
///
/// A probe in place P with direction n indicates n . (d + e x P): on a face with normal Z, p = d_z - u e_y + v e_x. The
/// displacements d and angles e that the probes determine together are found by weighted least squares; a rotation that
/// acts on every probe of a face alike (one dial cannot see pitch) is left out, and a note says which displacement
/// contains it. Where only a combination of components is seen the answer is a status, no figures.
///
/// Datum. Linear axis: the least-squares line over the positions is removed from each straightness (ISO 230-1:2012,
/// 3.4.6); positioning stays as indicated. Rotary axis: of each pair of radial displacements and of tilts the constants
/// and what turns once with the axis (eccentricity and wobble of the mandrel, common to both) are removed (ISO 230-7),
/// of the axial displacement its mean; the rotation about the axis itself is not seen on a mandrel.
///
/// Two one-dial grids are the case of probes at equal u: with equal uncertainties the roll is
/// (w_y k_z - w_z k_y) / (w_y + w_z), k the slopes of the rows and w = sum (place - mean)^2.
/// @throws std::invalid_argument for sizes that do not fit, positions that do not increase, directions that are not of
///         unit length, uncertainties that are not positive
/// Source: docs/dial-grids.md.
Decoupling decouple_indications(const AxisIndications& readings, AngleDatum datum = AngleDatum::as_indicated);

/// Indications of given errors without noise, with exact rotations: n . (d + (R(e) - I) P).
/// @param errors  [m, 6] mm, rad, in the order of Component
/// @return [m, k] mm
Eigen::MatrixXd exact_indications(const AxisIndications& readings, const Eigen::MatrixXd& errors);

}  // namespace abbe
