#pragma once

// Internal to study: errors of two campaigns in one model and one gauge, each by itself.
#include "abbe/study/comparison_model.h"

namespace abbe {

/// Fills errors and the test of all of them, except for `at_tool`.
///
/// A change d = G (x_2 - x_1) has the covariance K = G (C_1 + C_2) G', G orthonormal combinations of the parameters of
/// an error; d' K^+ d is chi-square with rank(K) degrees of freedom if nothing changed.
/// All errors are tested together only where both campaigns have one gauge from the beginning: readings can know some
/// combinations of errors a thousand times better than each of them, better than an S-transformation, which is of first
/// order, brings them into another gauge.
/// @param curves  whether curves are wanted
/// @param moved   whether the campaigns were brought into one gauge
void compare_errors(const ComparisonModel& model, double level, bool curves, bool moved, ComparedPair& pair);

}  // namespace abbe
