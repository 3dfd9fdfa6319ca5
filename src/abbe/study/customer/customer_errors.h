#pragma once

#include <Eigen/Core>

#include "abbe/errors/error_set.h"
#include "abbe/report/customer/customer_report.h"

namespace abbe {

// Parts of a study's customer report.

/// Identified errors of a machine before or after a correction. Those that still have a state, which follows from the
/// commands, are in maps alone: the figures hold where their factors are zero.
struct CustomerErrors {
  const Machine& machine;
  ErrorSet errors;
  Eigen::MatrixXd covariance;  ///< of the parameters of the errors, mm and rad; 0 x 0: not stated
  ReportLanguage language;
};

/// Ranges of the error motions, location errors and reversal values, in chain order of their axes. Two states: as
/// measured, and what is predicted to be left.
std::vector<CustomerFigure> customer_error_figures(const CustomerErrors& of);

/// A table for every axis with error motions: their values with expanded uncertainties at evenly spaced positions.
std::vector<CustomerTable> customer_error_tables(const CustomerErrors& of);

/// Positioning error motions of the linear and of the rotary axes with their bands; of each kind that there is.
std::vector<CustomerDrawing> customer_error_drawings(const CustomerErrors& of);

}  // namespace abbe
