#pragma once

// Internal to study: errors of two campaigns in one model and one gauge, each by itself.
#include "abbe/study/comparison/comparison_model.h"

namespace abbe {

struct ErrorTests {
  double level = 0.05;    ///< of significance, of the family of errors
  bool curves = false;    ///< curves of error motions are wanted
  bool one_gauge = true;  ///< both campaigns have had one from the beginning
};

/// Fills errors and the test of all of them, except for `at_tool`.
///
/// A change d = G (x_2 - x_1) has the covariance K = G (C_1 + C_2) G', G orthonormal combinations of the parameters of
/// an error; d' K^+ d is chi-square with rank(K) degrees of freedom if nothing changed.
/// All errors are tested together only where both campaigns have one gauge from the beginning: readings can know some
/// combinations of errors a thousand times better than each of them, better than an S-transformation, which is of first
/// order, brings them into another gauge.
void compare_errors(const ComparisonModel& model, const ErrorTests& tests, ComparedPair& pair);

}  // namespace abbe
