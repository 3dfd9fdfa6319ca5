#pragma once

#include <vector>

#include "abbe/errors/error_set.h"
#include "abbe/errors/poses.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// An error of a machine that is not in a model of its errors and cannot be expressed by those that are.
struct UnmodelledError {
  std::size_t axis = 0;
  Component component = Component::X;
  bool is_location = false;
  /// Root mean square displacement of the functional point by an error of typical size, without what a rigid motion of
  /// the workpiece and the errors of the model could take up; mm. Error motions: in the mean over their second and
  /// third order (linear) or second harmonic (rotary), the shapes that are no location error.
  double effect = 0;
};

struct UnmodelledErrorOptions {
  double typical_length = 0.01;  ///< mm, size of an error motion or a location error of a usual machine
  double typical_angle = 5e-5;   ///< rad
};

/// Error motions and location errors of a machine on which the displacement of its functional point depends at these
/// poses, and which are not in the model: whoever identifies the model takes them as zero, and the uncertainty of the
/// result does not cover them.
///
/// First the six error motions of every axis that moves, in chain order. Then location errors: of linear axes those
/// that are independent while all of them may turn together, from the last of X, Y, Z on (squareness: EA0Z, EB0Z,
/// EC0Y), of rotary axes position and tilt of the axis average line as far as independent. Zero positions and the tool
/// offset are measured whenever a workpiece or a tool is set up and are not listed. An error is listed if more than
/// 1e-3 of its effect is left beside rigid motions and the model. To first order at errors of zero.
/// @param model  its ranges decide which poses count
/// @throws std::invalid_argument if the poses do not fit the machine
std::vector<UnmodelledError> unmodelled_errors(const Machine& machine, const ErrorSet& model, const PoseSource& poses,
                                               const UnmodelledErrorOptions& options = {});

/// The set without the listed errors: what is left of a true machine if they were zero.
ErrorSet errors_without(const ErrorSet& errors, const std::vector<UnmodelledError>& unmodelled);

/// The model with the listed errors added at value zero, error motions in their lowest orders over these ranges.
/// Motions and locations of the model come first among theirs.
/// @param from, to  [axes] mm or rad
ErrorSet errors_with(const Machine& machine, const ErrorSet& model, const std::vector<UnmodelledError>& unmodelled,
                     const std::vector<double>& from, const std::vector<double>& to);

/// First function of an error motion of errors_with() that is neither a constant nor a slope nor turns with the axis.
std::size_t first_shape(const Basis& basis);

}  // namespace abbe
