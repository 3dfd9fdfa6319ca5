#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "abbe/errors/error_set.h"
#include "abbe/errors/poses.h"

namespace abbe {

/// What random_errors() draws. Amplitudes are relative to each other; the size of the whole is set by the scaling.
struct RandomErrorOptions {
  std::uint64_t seed = 1;
  int linear_order = 4;           ///< Legendre degree over the travel, linear axes
  int rotary_harmonics = 4;       ///< Fourier harmonics, rotary axes with a whole turn or endless
  int rotary_order = 4;           ///< Legendre degree, rotary axes with less than a turn
  double decay = 0.6;             ///< each higher degree or harmonic is smaller by this factor
  bool constant_terms = false;    ///< also draw P0 or the constant (a gauge freedom against the location errors)
  bool motions = true;            ///< draw error motions
  bool locations = true;          ///< draw location errors
  double translation_um = 10;     ///< standard deviation of the first coefficient of a translation
  double rotation_urad = 20;      ///< the same for a rotation
  double location_um = 20;        ///< standard deviation of a location error in length
  double location_urad = 50;      ///< the same in angle
  std::vector<std::string> only;  ///< error names ("EXX", "EC0Y") to draw; empty: all valid ones
};

/// Smooth random errors: every chosen error motion with a Legendre or Fourier basis and decaying normal coefficients,
/// every valid location error of a principal-direction axis. The same seed gives the same errors on every machine.
/// @throws std::invalid_argument for a name in `only` that is no error of the machine
ErrorSet random_errors(const Machine& machine, const RandomErrorOptions& options);

enum class VolumetricMeasure { mean, maximum };

/// What the size of the errors means.
struct VolumetricTarget {
  VolumetricMeasure measure = VolumetricMeasure::mean;
  double value_um = 100;             ///< wanted norm of the functional point's deviation in the workpiece frame
  bool remove_rigid_motion = false;  ///< after removing the best-fit rigid motion (choice of workpiece datum)
  std::size_t points_per_axis = 5;   ///< sampling of the travel: grid of so many positions, at most 20,000 poses
};

/// Norm of the functional point's deviation over the sampling, mm; see VolumetricTarget.
double volumetric_error(const Machine& machine, const ErrorSet& errors, const VolumetricTarget& target);

/// Multiplies all coefficients, location errors and the tool offset error by one factor so that volumetric_error() is
/// target.value_um to 1e-9 of it.
/// @returns the factor; 0 if the errors have no effect and cannot be scaled (they are then left as they are)
double scale_errors(const Machine& machine, ErrorSet& errors, const VolumetricTarget& target);

}  // namespace abbe
