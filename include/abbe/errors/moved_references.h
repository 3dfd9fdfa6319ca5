#pragma once

#include <Eigen/Core>
#include <span>

#include "abbe/errors/error_set.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// The same errors about other references of the measured and lag states.
///
/// With T the old and T' the new reference, the factor v - T is (v - T') + (T' - T), so a term with a state is the same
/// term about T' and (T' - T) times that term without the state. Errors at every state stay what they are; terms
/// without a state become the errors at the new references.
///
/// Such a part is added to the term of the same error with the same functions, or with the same functions and more of
/// them (polynomials, harmonics). Where there is none, it is a term of its own.
///
/// @param values         [states] new references of measured and lag states in their unit; NaN: the reference stays
/// @param by_parameters  if not null: d(parameters of the result)/d(parameters of the errors)
ErrorSet with_references(const Machine& machine, const ErrorSet& errors, std::span<const double> values,
                         Eigen::MatrixXd* by_parameters = nullptr);

/// The machine with these references, for with_references().
Machine with_references(Machine machine, std::span<const double> values);

}  // namespace abbe
