#pragma once

#include <optional>

#include "abbe/study/study_result.h"

namespace abbe {

/// The errors that the identification would find from readings without noise and without outliers, with everything that
/// was known beforehand known as it really is: the truth in the model's basis functions and in the result's gauge, so
/// that both may be compared coefficient by coefficient.
///
/// What was known stays in the fit: without it directions would be open that the gauge does not fix, and the solution
/// would lie anywhere along them.
/// @returns nothing for measured studies, or if that fit does not converge
std::optional<ErrorSet> truth_in_gauge(const Study& study, const StudyResult& result);

/// True values of a model's machine parameters: the coefficients that are nearest to the true error motions, and the
/// true location errors. The tool offset error is the true one.
/// @param model  motions and locations in which the truth is wanted
std::vector<double> true_parameters(const ErrorSet& truth, const ErrorSet& model);

}  // namespace abbe
