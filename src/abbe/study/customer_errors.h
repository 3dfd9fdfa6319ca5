#pragma once

#include "abbe/report/customer/customer_report.h"

namespace abbe {

struct Study;
struct StudyResult;

// Parts of a study's customer report; the result is usable.

/// Ranges of the error motions, location errors and reversal values, in chain order of their axes.
std::vector<CustomerFigure> customer_error_figures(const Study& study, const StudyResult& result);

/// A table for every axis with error motions: their values with expanded uncertainties at evenly spaced positions.
std::vector<CustomerTable> customer_error_tables(const Study& study, const StudyResult& result);

/// Positioning error motions of the linear and of the rotary axes with their bands; of each kind that there is.
std::vector<CustomerDrawing> customer_error_drawings(const Study& study, const StudyResult& result);

}  // namespace abbe
